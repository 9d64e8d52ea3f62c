// line_transform.h: the discrete Fourier transform of eight lines of complex numbers side by side.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace kiln::linalg {

/// Eight lines of complex numbers: number n of line l has its real part at real()[8 n + l] and its imaginary part at the same place
/// of imaginary(). A transform swaps the lines with the spare place behind them, so pointers hold until the next one.
class Lines {
   public:
    static constexpr std::size_t lanes = 8;

    explicit Lines(std::size_t length)
        : memory_(4 * length), real_(memory_.data()->value), imaginary_(real_ + lanes * length),
          spare_real_(imaginary_ + lanes * length), spare_imaginary_(spare_real_ + lanes * length) {}
    Lines(Lines&&) = default;

    float* real() { return real_; }
    float* imaginary() { return imaginary_; }

   private:
    friend class LineTransform;
    struct alignas(32) Eight {
        float value[lanes];
    };
    std::vector<Eight> memory_;
    float *real_, *imaginary_, *spare_real_, *spare_imaginary_;
};

/// Transform of lines of one length, any length; quick for those without prime factors above 5. Single precision; a line's result
/// does not depend on the lines beside it. Stockham's ordering: Van Loan, Computational frameworks for the fast Fourier transform,
/// 1992, section 1.7. The vector unit works across the lines.
class LineTransform {
   public:
    explicit LineTransform(std::size_t length);

    std::size_t length() const { return length_; }

    /// x_k <- sum over n of x_n exp(-2 pi i n k/length).
    void forward(Lines& lines) const { run(lines.real_, lines.imaginary_, lines.spare_real_, lines.spare_imaginary_); }

    /// x_n <- sum over k of x_k exp(+2 pi i n k/length): length times the inverse.
    void backward(Lines& lines) const { run(lines.imaginary_, lines.real_, lines.spare_imaginary_, lines.spare_real_); }

   private:
    struct Stage {
        std::size_t radix, blocks, stride;  // blocks: butterflies with twiddles of their own; stride: numbers from one to the next
        std::vector<float> real, imaginary; // twiddles: radix for each block
    };

    void run(float*& real, float*& imaginary, float*& spare_real, float*& spare_imaginary) const;

    std::size_t length_;
    std::vector<Stage> stages_;
    std::vector<std::vector<float>> roots_;  // cos and sin for radices above 5, empty for others: one of each stage
};

/// The smallest number of at least `count` without prime factors above 5.
std::size_t quick_length(std::size_t count);

}  // namespace kiln::linalg
