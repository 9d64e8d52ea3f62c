// line_transform.cpp: butterflies of two, three, four, five and any number of points.
#include "linalg/line_transform.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace kiln::linalg {

namespace {

constexpr std::size_t width = 4;  // floats in a register of every x86-64 processor
using Wide [[gnu::vector_size(width * sizeof(float)), gnu::may_alias]] = float;

struct Complex {
    Wide re, im;
};

/// One complex number of each of some lines.
struct From {
    const Wide *re, *im;
    Complex operator[](std::size_t i) const { return {re[i], im[i]}; }
};

struct To {
    Wide *re, *im;

    /// Puts value times a twiddle.
    void put(std::size_t i, const Complex& value, float cosine, float sine) const {
        re[i] = value.re * cosine - value.im * sine;
        im[i] = value.re * sine + value.im * cosine;
    }
    void put(std::size_t i, const Complex& value) const {
        re[i] = value.re;
        im[i] = value.im;
    }
};

Complex operator+(const Complex& a, const Complex& b) { return {a.re + b.re, a.im + b.im}; }
Complex operator-(const Complex& a, const Complex& b) { return {a.re - b.re, a.im - b.im}; }
Complex operator*(float factor, const Complex& a) { return {factor * a.re, factor * a.im}; }
/// a - i b and a + i b.
Complex minus_i(const Complex& a, const Complex& b) { return {a.re + b.im, a.im - b.re}; }
Complex plus_i(const Complex& a, const Complex& b) { return {a.re - b.im, a.im + b.re}; }

/// What a butterfly reads and writes: point j at from[i + j * in], point k at to[i + k * out], with twiddles of the block.
struct Butterfly {
    From from;
    To to;
    std::size_t in, out;
    const float *cosine, *sine;
};

template <std::size_t Radix>
void butterflies(const Butterfly& b, std::size_t count);

template <>
void butterflies<2>(const Butterfly& b, std::size_t count) {
    const float c1 = b.cosine[1], s1 = b.sine[1];
    for (std::size_t i = 0; i < count; ++i) {
        const Complex x0 = b.from[i], x1 = b.from[i + b.in];
        b.to.put(i, x0 + x1);
        b.to.put(i + b.out, x0 - x1, c1, s1);
    }
}

template <>
void butterflies<3>(const Butterfly& b, std::size_t count) {
    constexpr float half_root3 = 0.866025403784438647f;
    const float c1 = b.cosine[1], s1 = b.sine[1], c2 = b.cosine[2], s2 = b.sine[2];
    for (std::size_t i = 0; i < count; ++i) {
        const Complex x0 = b.from[i], x1 = b.from[i + b.in], x2 = b.from[i + 2 * b.in];
        const Complex sum = x1 + x2, middle = x0 - 0.5f * sum, turned = half_root3 * (x1 - x2);
        b.to.put(i, x0 + sum);
        b.to.put(i + b.out, minus_i(middle, turned), c1, s1);
        b.to.put(i + 2 * b.out, plus_i(middle, turned), c2, s2);
    }
}

template <>
void butterflies<4>(const Butterfly& b, std::size_t count) {
    const float c1 = b.cosine[1], s1 = b.sine[1], c2 = b.cosine[2], s2 = b.sine[2], c3 = b.cosine[3], s3 = b.sine[3];
    for (std::size_t i = 0; i < count; ++i) {
        const Complex x0 = b.from[i], x1 = b.from[i + b.in], x2 = b.from[i + 2 * b.in], x3 = b.from[i + 3 * b.in];
        const Complex even = x0 + x2, odd = x1 + x3, even_difference = x0 - x2, odd_difference = x1 - x3;
        b.to.put(i, even + odd);
        b.to.put(i + b.out, minus_i(even_difference, odd_difference), c1, s1);
        b.to.put(i + 2 * b.out, even - odd, c2, s2);
        b.to.put(i + 3 * b.out, plus_i(even_difference, odd_difference), c3, s3);
    }
}

template <>
void butterflies<5>(const Butterfly& b, std::size_t count) {
    constexpr float cos1 = 0.309016994374947424f, cos2 = -0.809016994374947424f;
    constexpr float sin1 = 0.951056516295153572f, sin2 = 0.587785252292473129f;
    const float *c = b.cosine, *s = b.sine;
    for (std::size_t i = 0; i < count; ++i) {
        const Complex x0 = b.from[i], x1 = b.from[i + b.in], x2 = b.from[i + 2 * b.in];
        const Complex x3 = b.from[i + 3 * b.in], x4 = b.from[i + 4 * b.in];
        const Complex sum1 = x1 + x4, sum2 = x2 + x3, difference1 = x1 - x4, difference2 = x2 - x3;
        const Complex real1 = x0 + (cos1 * sum1 + cos2 * sum2), real2 = x0 + (cos2 * sum1 + cos1 * sum2);
        const Complex turned1 = sin1 * difference1 + sin2 * difference2, turned2 = sin2 * difference1 - sin1 * difference2;
        b.to.put(i, x0 + (sum1 + sum2));
        b.to.put(i + b.out, minus_i(real1, turned1), c[1], s[1]);
        b.to.put(i + 2 * b.out, minus_i(real2, turned2), c[2], s[2]);
        b.to.put(i + 3 * b.out, plus_i(real2, turned2), c[3], s[3]);
        b.to.put(i + 4 * b.out, plus_i(real1, turned1), c[4], s[4]);
    }
}

/// Any number of points by the sum itself; roots: cosines, then sines of -2 pi n/radix.
void butterflies(const Butterfly& b, std::size_t radix, const float* roots, std::size_t count) {
    for (std::size_t k = 0; k < radix; ++k) {
        for (std::size_t i = 0; i < count; ++i) {
            Complex sum = b.from[i];
            for (std::size_t j = 1; j < radix; ++j) {
                const std::size_t n = j * k % radix;
                const Complex x = b.from[i + j * b.in];
                sum = sum + Complex{x.re * roots[n] - x.im * roots[radix + n], x.re * roots[radix + n] + x.im * roots[n]};
            }
            b.to.put(i + k * b.out, sum, b.cosine[k], b.sine[k]);
        }
    }
}

double angle(std::size_t part, std::size_t whole) {
    return -2.0 * std::numbers::pi * static_cast<double>(part % whole) / static_cast<double>(whole);
}

/// Factors 4, then 2, 3, 5 and what is left.
std::vector<std::size_t> factors_of(std::size_t length) {
    std::vector<std::size_t> factors;
    for (const std::size_t factor : {std::size_t{4}, std::size_t{2}, std::size_t{3}}) {
        while (length % factor == 0) {
            factors.push_back(factor);
            length /= factor;
        }
    }
    for (std::size_t factor = 5; length > 1; factor += 2) {
        if (factor * factor > length) factor = length;
        while (length % factor == 0) {
            factors.push_back(factor);
            length /= factor;
        }
    }
    return factors;
}

}  // namespace

LineTransform::LineTransform(std::size_t length) : length_(length) {
    std::size_t stride = 1;
    for (const std::size_t radix : factors_of(length)) {
        const std::size_t blocks = length / (radix * stride), whole = radix * blocks;
        Stage stage{radix, blocks, stride, std::vector<float>(whole), std::vector<float>(whole)};
        for (std::size_t block = 0; block < blocks; ++block) {
            for (std::size_t k = 0; k < radix; ++k) {
                stage.real[radix * block + k] = static_cast<float>(std::cos(angle(block * k, whole)));
                stage.imaginary[radix * block + k] = static_cast<float>(std::sin(angle(block * k, whole)));
            }
        }
        std::vector<float> roots;
        for (std::size_t n = 0; radix > 5 && n < 2 * radix; ++n)
            roots.push_back(static_cast<float>(n < radix ? std::cos(angle(n, radix)) : std::sin(angle(n - radix, radix))));
        stages_.push_back(std::move(stage));
        roots_.push_back(std::move(roots));
        stride *= radix;
    }
}

void LineTransform::run(float*& real, float*& imaginary, float*& spare_real, float*& spare_imaginary) const {
    constexpr std::size_t registers = Lines::lanes / width;
    for (std::size_t index = 0; index < stages_.size(); ++index) {
        const Stage& stage = stages_[index];
        const std::size_t count = stage.stride * registers;
        for (std::size_t block = 0; block < stage.blocks; ++block) {
            const std::size_t first = block * count, twiddle = block * stage.radix;
            const Butterfly butterfly{
                {reinterpret_cast<const Wide*>(real) + first, reinterpret_cast<const Wide*>(imaginary) + first},
                {reinterpret_cast<Wide*>(spare_real) + first * stage.radix,
                 reinterpret_cast<Wide*>(spare_imaginary) + first * stage.radix},
                stage.blocks * count,
                count,
                stage.real.data() + twiddle,
                stage.imaginary.data() + twiddle};
            switch (stage.radix) {
                case 2: butterflies<2>(butterfly, count); break;
                case 3: butterflies<3>(butterfly, count); break;
                case 4: butterflies<4>(butterfly, count); break;
                case 5: butterflies<5>(butterfly, count); break;
                default: butterflies(butterfly, stage.radix, roots_[index].data(), count);
            }
        }
        std::swap(real, spare_real);
        std::swap(imaginary, spare_imaginary);
    }
}

std::size_t quick_length(std::size_t count) {
    for (std::size_t length = std::max<std::size_t>(count, 1);; ++length) {
        std::size_t rest = length;
        for (const std::size_t factor : {std::size_t{2}, std::size_t{3}, std::size_t{5}})
            while (rest % factor == 0) rest /= factor;
        if (rest == 1) return length;
    }
}

}  // namespace kiln::linalg
