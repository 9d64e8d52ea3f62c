// memory.cpp: settings of the heap, and large pages for large arrays.
#include "tools/common/memory.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <new>

namespace kiln::cli {

void set_up_memory() {
#ifdef __GLIBC__
    mallopt(M_MMAP_MAX, 0);         // arrays come from the heap, however large
    mallopt(M_TRIM_THRESHOLD, -1);  // which never shrinks
    mallopt(M_TOP_PAD, 64 << 20);   // bytes of address space ahead of use, so that large pages fit in
    mallopt(M_ARENA_MAX, 1);        // a heap for each thread takes an eighth more memory and saves no time
#endif
}

}  // namespace kiln::cli

// Neighbours and bonds jump about in arrays of many megabytes; with pages of 4 KB most of these jumps miss the processor's table of
// pages. The sanitizers have an operator new of their own, which finds more faults.
#if defined(MADV_HUGEPAGE) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

namespace {

constexpr std::size_t large_page = 2 << 20;         // bytes
constexpr std::size_t large_array = large_page / 8;  // from which the system is asked for large pages

/// Advice for the memory, and for what the heap has beyond it. What the system does not grant costs nothing.
void advise(void* memory, std::size_t size) {
    const auto begin = reinterpret_cast<std::uintptr_t>(memory), end_of_heap = reinterpret_cast<std::uintptr_t>(sbrk(0));
    const std::uintptr_t first = begin / large_page * large_page, last = begin < end_of_heap ? end_of_heap : begin + size;
    madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
}

template <typename Allocate>
void* allocated(std::size_t size, const Allocate& allocate) {
    while (true) {
        if (void* memory = allocate()) {
            if (size >= large_array) advise(memory, size);
            return memory;
        }
        const std::new_handler handler = std::get_new_handler();
        if (!handler) throw std::bad_alloc();
        handler();
    }
}

}  // namespace

// Not inline: where one is and the other is not, the compiler takes them for no pair.
[[gnu::noinline]] void* operator new(std::size_t size) {
    return allocated(size, [&] { return std::malloc(size > 0 ? size : 1); });
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
    const auto unit = static_cast<std::size_t>(alignment);
    return allocated(size, [&] { return std::aligned_alloc(unit, (size + unit - 1) / unit * unit); });
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

#endif
