#include "core/calibration/sphere/tcp_sphere_settle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/calibration/statistics.h"
#include "core/median.h"

namespace seamwright::tcp_sphere {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// A profile that is farther off than this, and than this many times what is usual, shows something else.
constexpr double kContradicts_mm = 0.15, kContradicts = 6;
constexpr double kNear_mm = 0.5;  // where a second look takes points for the sphere's

}  // namespace

double point_squares(const Section& section, const Model& model) {
    const Eigen::Vector3d s = centre_in_sensor(section, model);
    double sum = 0;
    for (size_t i = 0; i < section.x.size(); ++i) {
        const double dx = section.x[i] - s.x(), dz = section.z[i] - s.z();
        const double e = std::sqrt(dx * dx + s.y() * s.y() + dz * dz) - model.radius;
        sum += e * e;
    }
    return sum;
}

double section_rms(const Section& section, const Model& model) {
    return section.x.empty() ? kNaN : std::sqrt(point_squares(section, model) / section.count());
}

size_t used_count(const std::vector<Section>& sections) {
    return static_cast<size_t>(
        std::count_if(sections.begin(), sections.end(), [](const Section& s) { return s.used; }));
}

namespace {

bool spares_one(const std::vector<Section>& sections, bool radius_free) {
    return used_count(sections) > static_cast<size_t>(fewest_agreeing(radius_free));
}

// Profiles that contradict the sphere which the others agree on (they show something else, or their pose is
// wrong) stop being used, the worst first. Returns whether the set has changed.
bool leave_out_contradictions(std::vector<Section>& sections, const Model& model, bool radius_free) {
    std::vector<double> rms;
    for (const auto& section : sections)
        if (section.used) rms.push_back(section_rms(section, model));
    const double limit = std::max(kContradicts * median(rms), kContradicts_mm);
    Section* worst = nullptr;
    double worst_rms = limit;
    for (auto& section : sections) {
        if (!section.used) continue;
        const double value = section_rms(section, model);
        if (value > worst_rms) {
            worst_rms = value;
            worst = &section;
        }
    }
    if (worst == nullptr || !spares_one(sections, radius_free)) return false;
    worst->used = false;
    return true;
}

// One wrong pose bends least squares towards itself, so its own residual shows little: leave each out in
// turn. The one whose absence explains the disagreement (F test of its three numbers, guarded against picking
// the largest of many) and which the others then miss by more than 0.15 mm stops being used.
bool leave_out_wrong_pose(std::vector<Section>& sections, const Model& model, bool radius_free) {
    const size_t used = used_count(sections);
    const double unknowns = radius_free ? 10 : 9;
    const double redundancy = 3.0 * static_cast<double>(used - 1) - unknowns;
    if (!spares_one(sections, radius_free)) return false;
    double all = 0, own = 0, points = 0;
    for (const auto& section : sections) {
        if (!section.used) continue;
        all += disagreement(section, model) / section.count();
        own += section.own_squares;
        points += section.count();
    }
    const double mean_count = points / static_cast<double>(used);
    const double floor = own / points / mean_count * redundancy;
    Section* suspect = nullptr;
    double least = all;
    Model model_without = model;
    for (auto& section : sections) {
        if (!section.used) continue;
        section.used = false;
        Model candidate = model;
        const double rest =
            solve_reduced(sections, candidate, radius_free, std::numeric_limits<double>::infinity(), 20) *
            static_cast<double>(used - 1);
        section.used = true;
        if (rest < least) {
            least = rest;
            suspect = &section;
            model_without = candidate;
        }
    }
    if (suspect == nullptr) return false;
    const double f = (all - least) / 3 / (std::max(least, floor) / redundancy);
    if (f < outlier_limit(redundancy) || section_rms(*suspect, model_without) < kContradicts_mm) return false;
    suspect->used = false;
    return true;
}

// A profile in which something else was taken for the sphere: look again, only near where the sphere must be.
void look_again(Section& section, const Model& model, const CircleSectionLimits& limits) {
    const Eigen::Vector3d s = centre_in_sensor(section, model);
    constexpr double kAtThePole = 0.98;  // of the radius: nothing of the sphere is cut there
    if (std::abs(s.y()) > kAtThePole * model.radius) return;
    Profile near = *section.profile;
    for (size_t i = 0; i < near.size(); ++i) {
        const double dx = near.x_mm[i] - s.x(), dz = near.z_mm[i] - s.z();
        const double e = std::sqrt(dx * dx + s.y() * s.y() + dz * dz) - model.radius;
        if (!(std::abs(e) < kNear_mm)) near.z_mm[i] = kNaN;
    }
    const auto circle = find_circle_section(near, limits);
    if (!circle) return;
    Section again = section;
    take_inliers(again, *circle);
    if (section_rms(again, model) < kContradicts_mm) {
        take_inliers(section, *circle);
        section.used = true;
    }
}

}  // namespace

void settle(std::vector<Section>& sections, Model& model, bool radius_free, const CircleSectionLimits& limits,
            const std::vector<bool>& excluded) {
    const auto drop = [&] {
        for (size_t round = 0; round < sections.size(); ++round) {
            solve_reduced(sections, model, radius_free, std::numeric_limits<double>::infinity(), 40);
            if (!leave_out_contradictions(sections, model, radius_free) &&
                !leave_out_wrong_pose(sections, model, radius_free))
                break;
        }
    };
    // The robust start has already decided who agrees: begin from its residuals, or one gross profile would
    // bend the least squares before it can be seen.
    while (leave_out_contradictions(sections, model, radius_free)) {
    }
    drop();
    bool changed = false;
    for (size_t i = 0; i < sections.size(); ++i) {
        if (sections[i].used || excluded[sections[i].observation]) continue;
        look_again(sections[i], model, limits);
        changed = changed || sections[i].used;
    }
    if (changed) drop();
}

}  // namespace seamwright::tcp_sphere
