#include "core/features/end/end_choice.h"

#include <fmt/format.h>

#include <cmath>

namespace seamwright {
namespace {

constexpr double kNearlyAsLong = 0.9;
constexpr double kAsHigh = 3;  // sigma
constexpr std::size_t kMostNamed = 4;

struct EndsInWindow {
    const ContourSheets& sheets;
    const EndRule& rule;

    double outward(int i) const {
        return (rule.side == EndSide::right ? 1 : -1) * sheets.x()[std::size_t(i)];
    }
    bool at_last(const ContourSheet& s) const { return outward(s.first + s.count - 1) >= outward(s.first); }
    int end(const ContourSheet& s) const { return at_last(s) ? s.first + s.count - 1 : s.first; }
    double reach(const ContourSheet& s) const { return outward(end(s)); }
    ContourSheetEnd how(const ContourSheet& s) const { return at_last(s) ? s.after : s.before; }
    bool counts(const ContourSheet& s) const { return s.count >= rule.minimum_points; }
    Eigen::Vector2d place(const ContourSheet& s) const {
        const auto i = static_cast<std::size_t>(end(s));
        return {sheets.x()[i], sheets.z()[i]};
    }
    double length(const ContourSheet& s) const {
        const auto a = static_cast<std::size_t>(s.first), b = a + static_cast<std::size_t>(s.count) - 1;
        return std::hypot(sheets.x()[b] - sheets.x()[a], sheets.z()[b] - sheets.z()[a]);
    }
    Eigen::Vector2d middle(const ContourSheet& s) const {
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        for (int i = s.first; i < s.first + s.count; ++i)
            sum += Eigen::Vector2d(sheets.x()[std::size_t(i)], sheets.z()[std::size_t(i)]);
        return sum / s.count;
    }
    // Across the direction that the sheets have in common, towards +z.
    Eigen::Vector2d up() const {
        double xx = 0, xz = 0, zz = 0;
        for (const ContourSheet& s : sheets.sheets()) {
            if (!counts(s)) continue;
            const Eigen::Vector2d m = middle(s);
            for (int i = s.first; i < s.first + s.count; ++i) {
                const double dx = sheets.x()[std::size_t(i)] - m.x(), dz = sheets.z()[std::size_t(i)] - m.y();
                xx += dx * dx, xz += dx * dz, zz += dz * dz;
            }
        }
        const double angle = 0.5 * std::atan2(2 * xz, xx - zz);
        const Eigen::Vector2d n(-std::sin(angle), std::cos(angle));
        return n.y() < 0 ? Eigen::Vector2d(-n) : n;
    }

    // The ends between which nothing decides, by name.
    std::string ambiguous(Feature& feature) const {
        feature.status = FeatureStatus::ambiguous;
        std::string places;
        for (const ContourSheet& s : sheets.sheets()) {
            if (!counts(s) || how(s) != ContourSheetEnd::open) continue;
            feature.rivals_mm.push_back(place(s));
            if (feature.rivals_mm.size() <= kMostNamed)
                places += fmt::format("{}x {:.2f} z {:.2f}", places.empty() ? "" : ", ", place(s).x(),
                                      place(s).y());
        }
        if (feature.rivals_mm.size() > kMostNamed)
            places += fmt::format(" + {}", feature.rivals_mm.size() - kMostNamed);
        return places;
    }

    const ContourSheet* only(Feature& feature) const {
        const ContourSheet *open = nullptr, *outside = nullptr, *any = nullptr;
        int ends = 0;
        for (const ContourSheet& s : sheets.sheets()) {
            if (!counts(s)) continue;
            if (!any || reach(s) > reach(*any)) any = &s;
            if (how(s) == ContourSheetEnd::open) open = &s, ++ends;
            if (how(s) == ContourSheetEnd::field && (!outside || reach(s) > reach(*outside))) outside = &s;
        }
        if (ends > 1) {
            feature.message = Text(
                "several contours end on that side: {}; say which by the window or by the setting segment",
                ambiguous(feature));
            return nullptr;
        }
        if (open && outside && reach(*outside) > reach(*open)) {
            feature.message = Text(
                "a contour ends on that side, {}, and another one leaves the sensor's field there; say which "
                "by the "
                "window or by the setting segment",
                ambiguous(feature));
            return nullptr;
        }
        return open ? open : any;
    }

    template <class Value>
    const ContourSheet* most(Value value, double margin, double share, const ContourSheet*& rival) const {
        const ContourSheet *best = nullptr, *next = nullptr;
        for (const ContourSheet& s : sheets.sheets()) {
            if (!counts(s)) continue;
            if (!best || value(s) > value(*best))
                next = best, best = &s;
            else if (!next || value(s) > value(*next))
                next = &s;
        }
        rival = next && value(*next) >= share * value(*best) - margin ? next : nullptr;
        return best;
    }

    const ContourSheet* outermost() const {
        const ContourSheet* found = nullptr;
        double limit = std::numeric_limits<double>::infinity();
        for (int n = 0; n < rule.order; ++n) {
            const ContourSheet* next = nullptr;
            for (const ContourSheet& s : sheets.sheets()) {
                if (!counts(s) || !(reach(s) < limit)) continue;
                // Which sheets the order counts: those that have an end. The first may be the one that has
                // none.
                if (rule.order > 1 && how(s) != ContourSheetEnd::open) continue;
                if (!next || reach(s) > reach(*next)) next = &s;
            }
            if (!next) return nullptr;
            found = next;
            limit = reach(*next);
        }
        return found;
    }
};

}  // namespace

std::optional<ChosenEnd> choose_end(const ContourSheets& sheets, const EndRule& rule, Feature& feature) {
    const EndsInWindow ends{sheets, rule};
    feature.status = FeatureStatus::not_found;
    int counted = 0;
    for (const ContourSheet& s : sheets.sheets()) counted += ends.counts(s);
    if (counted == 0) {
        feature.status = FeatureStatus::no_points;
        feature.message = Text("no segment with {} points in the window", rule.minimum_points);
        return std::nullopt;
    }
    const ContourSheet *chosen = nullptr, *rival = nullptr;
    switch (rule.of) {
        case EndOf::only:
            chosen = ends.only(feature);
            break;
        case EndOf::outermost:
            chosen = ends.outermost();
            if (!chosen)
                feature.message = Text("fewer than {} contours end on that side in the window", rule.order);
            break;
        case EndOf::longest:
            chosen =
                ends.most([&](const ContourSheet& s) { return ends.length(s); }, 0, kNearlyAsLong, rival);
            if (rival)
                feature.message = Text(
                    "two contours are about equally long: {}; say which by the window or by the setting "
                    "segment",
                    ends.ambiguous(feature));
            break;
        case EndOf::highest:
        case EndOf::lowest: {
            const Eigen::Vector2d up = ends.up() * (rule.of == EndOf::highest ? 1 : -1);
            chosen = ends.most([&](const ContourSheet& s) { return up.dot(ends.middle(s)); },
                               kAsHigh * sheets.noise_mm(), 1, rival);
            if (rival)
                feature.message = Text(
                    "two contours are equally high: {}; say which by the window or by the setting segment",
                    ends.ambiguous(feature));
            break;
        }
    }
    if (!chosen || rival) return std::nullopt;
    switch (ends.how(*chosen)) {
        case ContourSheetEnd::window:
            feature.message = "the contour runs on beyond the window on that side";
            return std::nullopt;
        case ContourSheetEnd::field:
            feature.message = Text(
                "the contour leaves the sensor's field on that side at x = {:.2f} mm: its end is not seen",
                ends.place(*chosen).x());
            return std::nullopt;
        case ContourSheetEnd::covered:
            // Who says which sheet is meant takes its end as it is seen.
            if (rule.of != EndOf::only) break;
            feature.message =
                Text("the contour runs under a higher one at x = {:.2f} mm: its end on that side is not seen",
                     ends.place(*chosen).x());
            return std::nullopt;
        case ContourSheetEnd::open:
            break;
    }
    return ChosenEnd{chosen->first, chosen->first + chosen->count - 1, ends.at_last(*chosen),
                     ends.at_last(*chosen) ? chosen->mixed_after : chosen->mixed_before,
                     ends.how(*chosen) == ContourSheetEnd::covered};
}

}  // namespace seamwright
