// Bits to grey values. Where the processor has SSSE3, eight pixels go at a time: a shuffle brings the two
// bytes that hold a pixel together, a multiplication shifts each lane by its own amount.

#include <cassert>
#include <cstring>

#include "devices/genicam/pixels/pixel_format.h"

#if defined(__x86_64__)
#include <tmmintrin.h>
#endif

namespace seamwright {
namespace {

using Bytes = const std::uint8_t*;

void store(std::byte* out, std::size_t i, unsigned value) {
    const auto word = static_cast<std::uint16_t>(value);
    std::memcpy(out + 2 * i, &word, 2);
}

// Pixel i of a stream: bits [bits * i, bits * i + bits), lowest first. Touches no byte beyond its last bit.
void unpack_lsb(Bytes in, std::size_t first, std::size_t count, int bits, std::byte* out) {
    const unsigned mask = (1U << bits) - 1;
    for (std::size_t i = first; i < count; ++i) {
        const std::size_t bit = i * static_cast<std::size_t>(bits);
        const unsigned low = in[bit / 8], high = in[bit / 8 + 1];  // 10 and 12 bit always span two bytes
        store(out, i, ((low | high << 8) >> (bit % 8)) & mask);
    }
}

void unpack_gige(Bytes in, std::size_t first, std::size_t count, int bits, std::byte* out) {
    const int low_bits = bits - 8;
    const unsigned mask = (1U << low_bits) - 1;
    for (std::size_t i = first; i < count; ++i) {
        const std::size_t pair = i / 2 * 3;
        const unsigned middle = in[pair + 1];
        if (i % 2 == 0)
            store(out, i, static_cast<unsigned>(in[pair]) << low_bits | (middle & mask));
        else
            store(out, i, static_cast<unsigned>(in[pair + 2]) << low_bits | (middle >> 4 & mask));
    }
}

#if defined(__x86_64__)
// All four return how many pixels they did; the last group reads 16 bytes, so they stop before the end.
#define SEAMWRIGHT_SSSE3 __attribute__((target("ssse3")))

SEAMWRIGHT_SSSE3 std::size_t fast_lsb(Bytes in, std::size_t bytes, std::size_t count, int bits,
                                      std::byte* out) {
    const __m128i gather10 = _mm_setr_epi8(0, 1, 1, 2, 2, 3, 3, 4, 5, 6, 6, 7, 7, 8, 8, 9);
    const __m128i gather12 = _mm_setr_epi8(0, 1, 1, 2, 3, 4, 4, 5, 6, 7, 7, 8, 9, 10, 10, 11);
    const __m128i up10 = _mm_setr_epi16(64, 16, 4, 1, 64, 16, 4, 1);
    const __m128i up12 = _mm_setr_epi16(16, 1, 16, 1, 16, 1, 16, 1);
    const __m128i gather = bits == 10 ? gather10 : gather12, up = bits == 10 ? up10 : up12;
    const __m128i down = _mm_cvtsi32_si128(16 - bits);
    std::size_t i = 0, at = 0;
    for (; i + 8 <= count && at + 16 <= bytes; i += 8, at += static_cast<std::size_t>(bits)) {
        const __m128i raw = _mm_loadu_si128(reinterpret_cast<const __m128i*>(in + at));
        const __m128i pairs = _mm_shuffle_epi8(raw, gather);
        _mm_storeu_si128(reinterpret_cast<__m128i*>(out + 2 * i),
                         _mm_srl_epi16(_mm_mullo_epi16(pairs, up), down));
    }
    return i;
}

SEAMWRIGHT_SSSE3 std::size_t fast_gige(Bytes in, std::size_t bytes, std::size_t count, int bits,
                                       std::byte* out) {
    // Even pixels: low byte the shared one, high byte the pixel's upper bits; odd pixels the same from the
    // other side, their low bits 4 further up.
    const __m128i gather = _mm_setr_epi8(1, 0, 1, 2, 4, 3, 4, 5, 7, 6, 7, 8, 10, 9, 10, 11);
    const int low_bits = bits - 8;
    const __m128i down = _mm_cvtsi32_si128(8 - low_bits);
    const auto high_mask = static_cast<short>(0xFF << low_bits),
               low_mask = static_cast<short>((1 << low_bits) - 1);
    const __m128i high = _mm_set1_epi16(high_mask);
    const __m128i low_even = _mm_setr_epi16(low_mask, 0, low_mask, 0, low_mask, 0, low_mask, 0);
    const __m128i low_odd = _mm_setr_epi16(0, low_mask, 0, low_mask, 0, low_mask, 0, low_mask);
    std::size_t i = 0, at = 0;
    for (; i + 8 <= count && at + 16 <= bytes; i += 8, at += 12) {
        const __m128i raw = _mm_loadu_si128(reinterpret_cast<const __m128i*>(in + at));
        const __m128i pairs = _mm_shuffle_epi8(raw, gather);
        const __m128i upper = _mm_and_si128(_mm_srl_epi16(pairs, down), high);
        const __m128i even = _mm_and_si128(pairs, low_even);
        const __m128i odd = _mm_and_si128(_mm_srli_epi16(pairs, 4), low_odd);
        _mm_storeu_si128(reinterpret_cast<__m128i*>(out + 2 * i),
                         _mm_or_si128(upper, _mm_or_si128(even, odd)));
    }
    return i;
}

bool have_ssse3() {
    static const bool have = __builtin_cpu_supports("ssse3") != 0;
    return have;
}
#endif

std::size_t packed_bytes(const PixelFormat& format, std::size_t count) {
    const std::size_t components = format.colour.size() == 3 ? 3 : 1;
    return (count * static_cast<std::size_t>(format.bits_per_pixel()) / components + 7) / 8;
}

}  // namespace

void unpack_pixels(const PixelFormat& format, std::span<const std::byte> packed, std::size_t count,
                   std::byte* out) {
    assert(!format.is_range() && packed.size() >= packed_bytes(format, count));
    const auto in = reinterpret_cast<Bytes>(packed.data());
    std::size_t done = 0;
    switch (format.packing) {
        case Packing::bytes:
            std::memcpy(out, in, count);
            return;
        case Packing::words:
            std::memcpy(out, in, 2 * count);
            return;
        case Packing::lsb:
#if defined(__x86_64__)
            if (have_ssse3()) done = fast_lsb(in, packed.size(), count, format.bit_depth, out);
#endif
            return unpack_lsb(in, done, count, format.bit_depth, out);
        case Packing::gige:
#if defined(__x86_64__)
            if (have_ssse3()) done = fast_gige(in, packed.size(), count, format.bit_depth, out);
#endif
            return unpack_gige(in, done, count, format.bit_depth, out);
        case Packing::floats:
            assert(false);
    }
}

void pack_pixels(const PixelFormat& format, const std::byte* pixels, std::size_t count, std::byte* out) {
    assert(!format.is_range());
    const auto value = [pixels](std::size_t i) {
        std::uint16_t word = 0;
        std::memcpy(&word, pixels + 2 * i, 2);
        return static_cast<unsigned>(word);
    };
    auto* to = reinterpret_cast<std::uint8_t*>(out);
    const int low_bits = format.bit_depth - 8;
    switch (format.packing) {
        case Packing::bytes:
            std::memcpy(out, pixels, count);
            return;
        case Packing::words:
            std::memcpy(out, pixels, 2 * count);
            return;
        case Packing::lsb: {
            std::memset(out, 0, packed_bytes(format, count));
            for (std::size_t i = 0; i < count; ++i) {
                const std::size_t bit = i * static_cast<std::size_t>(format.bit_depth);
                const unsigned shifted = value(i) << (bit % 8);
                to[bit / 8] = static_cast<std::uint8_t>(to[bit / 8] | (shifted & 0xFF));
                to[bit / 8 + 1] = static_cast<std::uint8_t>(to[bit / 8 + 1] | (shifted >> 8));
            }
            return;
        }
        case Packing::gige:
            for (std::size_t i = 0; i < count; i += 2) {
                const unsigned p0 = value(i), p1 = i + 1 < count ? value(i + 1) : 0;
                const unsigned mask = (1U << low_bits) - 1;
                to[i / 2 * 3] = static_cast<std::uint8_t>(p0 >> low_bits);
                to[i / 2 * 3 + 1] = static_cast<std::uint8_t>((p0 & mask) | (p1 & mask) << 4);
                if (i + 1 < count) to[i / 2 * 3 + 2] = static_cast<std::uint8_t>(p1 >> low_bits);
            }
            return;
        case Packing::floats:
            assert(false);
    }
}

}  // namespace seamwright
