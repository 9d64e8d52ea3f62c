// wide_registers.h: the same code by registers of 32 bytes on processors that have them, chosen when the program runs.
#pragma once

namespace kiln::linalg {

#if defined(__x86_64__)
inline const bool has_wide_registers = (__builtin_cpu_init(), __builtin_cpu_supports("avx2") != 0);
#else
inline constexpr bool has_wide_registers = false;
#endif

#if defined(__x86_64__)
/// work(), compiled with all that it calls for AVX2, without the fused operations that would round otherwise.
template <typename Work>
[[gnu::target("avx2"), gnu::flatten, gnu::noinline]] auto in_wide_registers(const Work& work) {
    return work();
}
#endif

/// work(), which must not hand vectors of 32 bytes to functions that are compiled elsewhere. Gives the same bytes everywhere.
template <typename Work>
auto in_widest_registers(const Work& work) {
#if defined(__x86_64__)
    if (has_wide_registers) return in_wide_registers(work);
#endif
    return work();
}

}  // namespace kiln::linalg
