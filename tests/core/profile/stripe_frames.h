#pragma once
// Rendered frames with a known stripe, for the tests of the extraction.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <vector>

#include "core/profile/stripe/stripe_image.h"

namespace seamwright::testing {

// Owns pixels; rows may be longer than the width, the rest is filled with full scale to show who reads it.
class Frame {
  public:
    Frame(int width, int height, int bit_depth = 8, int extra_pixels = 0) {
        image_.width = width;
        image_.height = height;
        image_.bit_depth = bit_depth;
        image_.row_bytes = static_cast<std::size_t>(width + extra_pixels) * image_.bytes_per_pixel();
        data_.resize(image_.row_bytes * static_cast<std::size_t>(height));
        image_.pixels = data_.data();
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width + extra_pixels; ++x) set(x, y, x < width ? 0 : image_.full_scale());
    }
    Frame(const Frame&) = delete;
    Frame& operator=(const Frame&) = delete;

    void set(int x, int y, int grey) {
        std::byte* at =
            data_.data() + y * image_.row_bytes + static_cast<std::size_t>(x) * image_.bytes_per_pixel();
        const auto wide = static_cast<std::uint16_t>(grey);
        const auto narrow = static_cast<std::uint8_t>(grey);
        if (image_.bytes_per_pixel() == 2) {
            std::memcpy(at, &wide, 2);
        } else {
            std::memcpy(at, &narrow, 1);
        }
    }
    int get(int x, int y) const {
        const std::byte* at =
            data_.data() + y * image_.row_bytes + static_cast<std::size_t>(x) * image_.bytes_per_pixel();
        if (image_.bytes_per_pixel() == 1) return static_cast<int>(*at);
        std::uint16_t wide;
        std::memcpy(&wide, at, 2);
        return wide;
    }
    const StripeImage& image() const { return image_; }

  private:
    StripeImage image_;
    std::vector<std::byte> data_;
};

// Noise of a camera: variance = read^2 + grey/electrons_per_grey.
struct Noise {
    double read = 0;                // grey values, standard deviation
    double electrons_per_grey = 0;  // 0: no shot noise
    double variance(double grey) const {
        return read * read + (electrons_per_grey > 0 ? std::max(grey, 0.0) / electrons_per_grey : 0.0);
    }
};

// Light at (line, position along the line), in grey values before noise, clipping and rounding.
using Light = std::function<double(int line, double position)>;

inline void render(Frame& frame, ScanLines scan, const Light& light, const Noise& noise,
                   std::mt19937& random) {
    std::normal_distribution<double> normal;
    const StripeImage& image = frame.image();
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const double grey = scan == ScanLines::columns ? light(x, y) : light(y, x);
            const double spread = std::sqrt(noise.variance(grey));
            const double noisy = grey + (spread > 0 ? spread * normal(random) : 0.0);
            frame.set(x, y,
                      static_cast<int>(std::lround(std::clamp(noisy, 0.0, double(image.full_scale())))));
        }
    }
}

// A Gaussian stripe of standard deviation `spread_px`.
inline double gaussian_stripe(double position, double centre, double spread_px, double height) {
    const double u = (position - centre) / spread_px;
    return height * std::exp(-0.5 * u * u);
}

// Cramer-Rao bound of the centre of such a stripe in independent Gaussian noise; height, width and background
// unknown do not change it, since they are symmetric and the centre is antisymmetric.
inline double centre_bound(double spread_px, double height, double background, const Noise& noise,
                           double phase, double clip = 1e300) {
    double information = 0;
    for (int i = -60; i <= 60; ++i) {
        const double grey = gaussian_stripe(i, phase, spread_px, height);
        if (grey + background >= clip) continue;
        const double slope = grey * (i - phase) / (spread_px * spread_px);
        information += slope * slope / (noise.variance(grey + background) + 1.0 / 12);
    }
    return 1 / std::sqrt(information);
}

}  // namespace seamwright::testing
