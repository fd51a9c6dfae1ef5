#include "core/profile/stripe/stripe_light.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace seamwright {
namespace {

constexpr double kTarget = 0.7;           // of full scale, for the bright lines
constexpr double kDimmest = 0.45;         // bright lines below: too dark
constexpr double kBrightest = 0.93;       // above: too near to the cut, though nothing is cut off yet
constexpr double kSaturatedShare = 0.02;  // of the lit lines
constexpr double kFewestShare = 0.02;     // of the lines: fewer lit ones are noise, or a stray
constexpr int kFewest = 8;
constexpr double kFlooded = 0.6;  // surrounding level of an image without a stripe: washed out, not dark
constexpr double kWellLit = 0.1;  // of full scale: what a line needs to be measured well
constexpr double kMoreWithoutStripe = 16, kLessWhereFlooded = 0.06, kMost = 16;
constexpr double kBrightLines = 0.95, kDarkLines = 0.1;  // shares of the lit lines below their levels
// By the share of lines that are cut off, how much of the light is tried next.
constexpr double kAllCut = 0.95, kMostCut = 0.8, kManyCut = 0.4;
constexpr double kIfAll = 0.08, kIfMost = 0.15, kIfMany = 0.3, kIfSome = 0.5;
constexpr double kLeastBright = 1e-6;  // of full scale
constexpr float kSamePlace = 0.5F;     // of the width: two exposures of one stripe
constexpr double kSameLight = 1.02;    // no other frame would come of it
constexpr double kNarrowed = 1.15;     // between too dark and too bright: settled

double share_of(const std::vector<float>& sorted, double share) {
    return sorted[std::min(sorted.size() - 1,
                           static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
}

bool cut_off(const StripePeaks& peaks, int line) {
    return (peaks.flags[static_cast<std::size_t>(peaks.index(line, 0))] & StripePeaks::kSaturated) != 0;
}

float level_of(const StripePeaks& peaks, int line) {
    return peaks.intensity[static_cast<std::size_t>(peaks.index(line, 0))];
}

bool any(const StripePeaks& peaks, int line) {
    return peaks.count[static_cast<std::size_t>(line)] > 0;
}

bool too_few(const StripeLight& light) {
    return light.lit < std::max(kFewest, static_cast<int>(kFewestShare * light.lines));
}

}  // namespace

StripeLight stripe_light(const StripePeaks& peaks, int full_scale, const std::vector<std::uint8_t>& only) {
    StripeLight light;
    std::vector<float> levels, widths;
    for (int line = 0; line < peaks.lines; ++line) {
        if (!only.empty() && !only[static_cast<std::size_t>(line)]) continue;
        ++light.lines;
        if (!any(peaks, line)) continue;
        ++light.lit;
        light.saturated += cut_off(peaks, line);
        levels.push_back(level_of(peaks, line) / static_cast<float>(full_scale));
        widths.push_back(peaks.width_px[static_cast<std::size_t>(peaks.index(line, 0))]);
    }
    if (levels.empty()) return light;
    std::sort(levels.begin(), levels.end());
    std::sort(widths.begin(), widths.end());
    light.bright = share_of(levels, kBrightLines);
    light.middle = share_of(levels, 0.5);
    light.dark = share_of(levels, kDarkLines);
    light.width_px = share_of(widths, 0.5);
    return light;
}

double grey_level(const StripeImage& image, double share) {
    if (image.empty()) return 0;
    std::vector<int> sample;
    for (int v = 0; v < image.height; v += 8)
        for (int u = 0; u < image.width; u += 8) {
            const std::byte* at = image.pixels + static_cast<std::size_t>(v) * image.row_bytes +
                                  static_cast<std::size_t>(u * image.bytes_per_pixel());
            sample.push_back(image.bytes_per_pixel() == 1
                                 ? std::to_integer<int>(at[0])
                                 : std::to_integer<int>(at[0]) + 256 * std::to_integer<int>(at[1]));
        }
    const auto place =
        sample.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sample.size()));
    std::nth_element(sample.begin(), place, sample.end());
    return static_cast<double>(*place) / image.full_scale();
}

std::string_view to_string(LightVerdict verdict) {
    switch (verdict) {
        case LightVerdict::fit:
            return "fit";
        case LightVerdict::too_dark:
            return "too dark";
        case LightVerdict::too_bright:
            return "too bright";
        case LightVerdict::no_stripe:
            return "no stripe";
    }
    return "";
}

LightVerdict judge_light(const StripeLight& light, double surrounding) {
    if (too_few(light)) return surrounding > kFlooded ? LightVerdict::too_bright : LightVerdict::no_stripe;
    if (light.saturated_share() > kSaturatedShare || light.bright > kBrightest)
        return LightVerdict::too_bright;
    return light.bright < kDimmest ? LightVerdict::too_dark : LightVerdict::fit;
}

double wanted_light_factor(const StripeLight& light, double surrounding) {
    if (too_few(light)) return surrounding > kFlooded ? kLessWhereFlooded : kMoreWithoutStripe;
    // How far beyond the cut the stripe is cannot be seen; the more lines are cut off, the further.
    if (const double cut = light.saturated_share(); cut > kSaturatedShare)
        return cut > kAllCut ? kIfAll : cut > kMostCut ? kIfMost : cut > kManyCut ? kIfMany : kIfSome;
    return std::clamp(kTarget / std::max(light.bright, kLeastBright), 1 / kMost, kMost);
}

LightSearch::LightSearch(double start, double lowest, double highest)
    : next_(std::clamp(start, lowest, highest)), lowest_(lowest), highest_(highest), best_(next_) {}

bool LightSearch::seen(const StripeLight& light, double surrounding) {
    const LightVerdict now = judge_light(light, surrounding);
    const double tried = next_;
    // A stripe beats none, and a dark one that is whole beats one that is cut off.
    const auto rank = [](LightVerdict v) {
        switch (v) {
            case LightVerdict::fit:
                return 3;
            case LightVerdict::too_dark:
                return 2;
            case LightVerdict::too_bright:
                return 1;
            case LightVerdict::no_stripe:
                return 0;
        }
        return 0;
    };
    const bool better =
        rank(now) > rank(verdict_) ||
        (now == verdict_ && (now == LightVerdict::too_bright ? tried < best_ : tried > best_));
    if (better) {
        best_ = tried;
        verdict_ = now;
    }
    if (now == LightVerdict::fit) return true;
    const bool glare = now == LightVerdict::too_bright;
    if (glare && (glare_ == 0 || tried < glare_)) glare_ = tried;
    if (!glare) dark_ = std::max(dark_, tried);
    double wanted = tried * wanted_light_factor(light, surrounding);
    if (dark_ > 0 && glare_ > 0) {
        if (glare_ / dark_ < kNarrowed) return true;
        if (wanted <= dark_ || wanted >= glare_) wanted = std::sqrt(dark_ * glare_);
    }
    next_ = std::clamp(wanted, lowest_, highest_);
    return next_ < tried * kSameLight && next_ * kSameLight > tried;
}

std::vector<std::uint8_t> unserved_lines(const StripePeaks& chosen, int full_scale,
                                         std::span<const StripePeaks> all) {
    std::vector<std::uint8_t> flags(static_cast<std::size_t>(chosen.lines), 0);
    for (int line = 0; line < chosen.lines; ++line) {
        const bool served =
            any(chosen, line) && level_of(chosen, line) >= kWellLit * static_cast<double>(full_scale);
        if (served) continue;
        flags[static_cast<std::size_t>(line)] =
            std::any_of(all.begin(), all.end(), [&](const StripePeaks& p) { return any(p, line); });
    }
    return flags;
}

namespace {

// Which exposure has the word on a line; `order`: by light, most first. -1: none sees it.
int chosen_exposure(std::span<const StripePeaks> exposures, std::span<const std::size_t> order, int line,
                    int full_scale) {
    int chosen = -1;
    for (const std::size_t k : order) {
        const StripePeaks& p = exposures[k];
        if (!any(p, line)) continue;
        if (chosen < 0 || cut_off(exposures[static_cast<std::size_t>(chosen)], line)) {
            chosen = static_cast<int>(k);
            continue;
        }
        if (cut_off(p, line) || level_of(p, line) < kWellLit * full_scale) continue;
        const StripePeaks& brighter = exposures[static_cast<std::size_t>(chosen)];
        const auto at = static_cast<std::size_t>(p.index(line, 0));
        const auto there = static_cast<std::size_t>(brighter.index(line, 0));
        if (std::abs(p.position_px[at] - brighter.position_px[there]) > kSamePlace * p.width_px[at])
            chosen = static_cast<int>(k);
    }
    return chosen;
}

}  // namespace

Expected<void> merge_exposures(std::span<const StripePeaks> exposures, std::span<const double> light,
                               int full_scale, StripePeaks& merged) {
    if (exposures.empty() || exposures.size() != light.size() ||
        std::any_of(light.begin(), light.end(), [](double l) { return !std::isfinite(l) || l <= 0; }))
        return usage_error(Text("{} exposures with {} lights", exposures.size(), light.size()), "merge",
                           "give each its light, above 0");
    const StripePeaks& first = exposures.front();
    for (const StripePeaks& p : exposures)
        if (p.lines != first.lines || p.per_line != first.per_line || p.scan != first.scan)
            return usage_error("the exposures differ in size", "merge",
                               "expose with one region of the image");
    std::vector<std::size_t> order(exposures.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return light[a] > light[b]; });
    const double least = light[order.back()];
    merged = first;
    for (int line = 0; line < first.lines; ++line) {
        const int k = chosen_exposure(exposures, order, line, full_scale);
        merged.count[static_cast<std::size_t>(line)] = 0;
        if (k < 0) continue;
        const StripePeaks& from = exposures[static_cast<std::size_t>(k)];
        merged.count[static_cast<std::size_t>(line)] = from.count[static_cast<std::size_t>(line)];
        const auto scale = static_cast<float>(least / light[static_cast<std::size_t>(k)]);
        for (int i = 0; i < from.per_line; ++i) {
            const auto at = static_cast<std::size_t>(from.index(line, i));
            merged.position_px[at] = from.position_px[at];
            merged.intensity[at] = from.intensity[at] * scale;
            merged.width_px[at] = from.width_px[at];
            merged.flags[at] = from.flags[at];
        }
    }
    return {};
}

}  // namespace seamwright
