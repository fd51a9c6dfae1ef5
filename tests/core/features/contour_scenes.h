#pragma once
// Joints and rims as a profile sensor sees them, drawn from geometry alone: which sheet lies where, what
// hides what, where it ends. Nothing here is shared with the estimators, with the simulated sensor or with
// contours.h.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/features/feature.h"
#include "core/profile/profile.h"

namespace seamwright::scenes {

using Eigen::Vector2d;

class Dice {
  public:
    explicit Dice(std::uint64_t seed) : random_(seed) {}
    double uniform(double a, double b) {
        return a + (b - a) * std::uniform_real_distribution<>(0, 1)(random_);
    }
    double spread(double a, double b) { return a * std::pow(b / a, uniform(0, 1)); }  // logarithmic
    double normal() { return std::normal_distribution<>()(random_); }
    bool chance(double p) { return uniform(0, 1) < p; }
    int of(int n) { return std::min(n - 1, static_cast<int>(uniform(0, n))); }

  private:
    std::mt19937_64 random_;
};

// One sheet's visible surface: a polygon in the plane of the laser, in order.
using Sheet = std::vector<Vector2d>;

inline Vector2d turned(const Vector2d& p, double rad) {
    const double c = std::cos(rad), s = std::sin(rad);
    return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
}
inline double rad(double deg) {
    return deg * std::numbers::pi / 180;
}
// Goes on from the sheet's last point on a circle: `bend` degrees to the left (+) or right, in the direction
// `heading` at the beginning.
inline void roll(Sheet& sheet, double heading_deg, double bend_deg, double radius) {
    const int n = std::max(4, static_cast<int>(std::abs(bend_deg)));
    const double step = bend_deg / n;
    for (int i = 0; i < n; ++i)
        sheet.push_back(sheet.back() + turned({2 * radius * std::sin(rad(std::abs(step)) / 2), 0},
                                              rad(heading_deg + (i + 0.5) * step)));
}
inline void go(Sheet& sheet, double heading_deg, double length) {
    sheet.push_back(sheet.back() + turned({length, 0}, rad(heading_deg)));
}

enum class Grid {
    raw,        // x carries noise as z does
    exact,      // x on an exact grid, noise in z alone
    resampled,  // measured with noise in both, then interpolated onto an exact grid
};

struct SensorModel {
    int points = 1280;
    double pitch = 0.05, noise = 0.02;
    Grid grid = Grid::raw;
    double missing = 0;         // share of single returns lost
    double quantum = 0;         // of z
    double steepest_deg = 84;   // steeper surface gives no return
    bool reversed = false;      // x falls in sensor order
    bool down = false;          // looks along -z: what is nearer to it has the smaller z
    bool rows_dropped = false;  // lines without return are not delivered at all
    double half_field() const { return 0.5 * pitch * points; }

    static SensorModel any(Dice& dice) {
        SensorModel s;
        static constexpr int counts[] = {320, 640, 800, 1024, 1280, 1920, 2048, 4096};
        do {
            s.points = counts[dice.of(8)];
            s.pitch = dice.spread(0.02, 0.3);
        } while (s.half_field() < 25 || s.half_field() > 150);
        s.noise = dice.spread(0.01, 0.1);
        s.grid = static_cast<Grid>(dice.of(3));
        s.missing = dice.chance(0.5) ? 0 : dice.uniform(0.005, 0.08);
        s.quantum = dice.chance(0.5) ? 0 : dice.spread(0.001, 0.02);
        s.reversed = dice.chance(0.3);
        return s;
    }
};

// Height of the uppermost sheet at every x of a fine list; NaN where there is none or where it is too steep.
inline std::vector<double> heights(const std::vector<Sheet>& sheets, const std::vector<double>& x,
                                   double steepest_deg) {
    const double none = -std::numeric_limits<double>::infinity();
    std::vector<double> z(x.size(), none);
    std::vector<char> steep(x.size(), 0);
    const double limit = std::tan(rad(steepest_deg));
    for (const Sheet& sheet : sheets)
        for (std::size_t k = 1; k < sheet.size(); ++k) {
            Vector2d a = sheet[k - 1], b = sheet[k];
            if (a.x() > b.x()) std::swap(a, b);
            const double slope = (b.y() - a.y()) / (b.x() - a.x());
            auto i = static_cast<std::size_t>(std::lower_bound(x.begin(), x.end(), a.x()) - x.begin());
            for (; i < x.size() && x[i] <= b.x(); ++i) {
                const double h = a.x() == b.x() ? b.y() : a.y() + slope * (x[i] - a.x());
                if (h <= z[i]) continue;
                z[i] = h;
                steep[i] = !(std::abs(slope) < limit);
            }
        }
    for (std::size_t i = 0; i < x.size(); ++i)
        if (steep[i] || z[i] == none) z[i] = std::numeric_limits<double>::quiet_NaN();
    return z;
}

inline Profile seen(const std::vector<Sheet>& sheets, const SensorModel& s, Dice& dice) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto n = static_cast<std::size_t>(s.points);
    const double first = -s.half_field() + 0.5 * s.pitch;
    std::vector<double> grid(n);
    for (std::size_t i = 0; i < n; ++i) grid[i] = first + s.pitch * double(i);
    Profile p;
    if (s.grid == Grid::resampled) {
        // Measured a little denser, with noise both ways (along the line less than its own points are apart, or
        // there were no order in them), then laid on the grid.
        const double fine = 0.7 * s.pitch, sideways = std::min(s.noise, 0.5 * fine);
        std::vector<double> at;
        for (double x = first - s.pitch; x < grid.back() + s.pitch; x += fine) at.push_back(x);
        std::vector<double> z = heights(sheets, at, s.steepest_deg), x = at;
        for (std::size_t i = 0; i < x.size(); ++i) {
            if (dice.chance(s.missing)) z[i] = nan;
            x[i] += sideways * dice.normal();
            z[i] += s.noise * dice.normal();
        }
        std::vector<std::size_t> order(x.size());
        for (std::size_t i = 0; i < x.size(); ++i) order[i] = i;
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
        p.x_mm = grid;
        p.z_mm.assign(n, nan);
        // Every stretch between two measured neighbours covers the lines in it.
        double from = 0, height = nan;
        for (const std::size_t i : order) {
            if (std::isnan(z[i])) continue;
            if (x[i] - from < 3 * fine + 3 * s.noise && !std::isnan(height))
                for (double k = std::max(0., std::ceil((from - first) / s.pitch));
                     k < double(n) && first + k * s.pitch <= x[i]; k += 1) {
                    const double t = (first + k * s.pitch - from) / std::max(x[i] - from, 1e-9);
                    p.z_mm[static_cast<std::size_t>(k)] = height + t * (z[i] - height);
                }
            from = x[i];
            height = z[i];
        }
    } else {
        p.x_mm = grid;
        p.z_mm = heights(sheets, grid, s.steepest_deg);
        for (std::size_t i = 0; i < n; ++i) {
            if (dice.chance(s.missing)) p.z_mm[i] = nan;
            if (s.grid == Grid::raw) p.x_mm[i] += s.noise * dice.normal();
            p.z_mm[i] += s.noise * dice.normal();
        }
    }
    if (s.quantum > 0)
        for (double& z : p.z_mm) z = s.quantum * std::round(z / s.quantum);
    if (s.rows_dropped) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < n; ++i)
            if (!std::isnan(p.z_mm[i])) p.x_mm[kept] = p.x_mm[i], p.z_mm[kept++] = p.z_mm[i];
        p.x_mm.resize(kept);
        p.z_mm.resize(kept);
    }
    if (s.reversed) {
        std::reverse(p.x_mm.begin(), p.x_mm.end());
        std::reverse(p.z_mm.begin(), p.z_mm.end());
    }
    if (s.down)
        for (double& z : p.z_mm) z = -z;
    return p;
}

// The mean of so many neighbours, of those that returned: a sensor's own smoothing.
inline void smooth(Profile& profile, int neighbours) {
    const std::vector<double> z = profile.z_mm;
    const int n = static_cast<int>(z.size()), half = neighbours / 2;
    for (int i = 0; i < n; ++i) {
        double sum = 0, many = 0;
        for (int k = std::max(i - half, 0); k <= std::min(i + half, n - 1); ++k)
            if (std::isfinite(z[std::size_t(k)])) sum += z[std::size_t(k)], ++many;
        if (std::isfinite(z[std::size_t(i)])) profile.z_mm[std::size_t(i)] = sum / many;
    }
}

// Noise that so many neighbours share, as a rough surface's speckle: nothing of the shape is smeared.
inline void speckle(Profile& profile, double noise, int neighbours, Dice& dice) {
    std::vector<double> white(profile.size() + std::size_t(neighbours));
    for (double& v : white) v = dice.normal();
    for (std::size_t i = 0; i < profile.size(); ++i) {
        double sum = 0;
        for (int k = 0; k < neighbours; ++k) sum += white[i + std::size_t(k)];
        profile.z_mm[i] += noise * sum / std::sqrt(neighbours);
    }
}

struct Scene {
    std::vector<Sheet> sheets;
    SensorModel sensor;
    Vector2d truth = Vector2d::Zero();  // of the feature that is meant
    double slope_deg = 0;               // of the contour there
    FeatureRecipe recipe;
    double loose_mm = 0;  // what the truth itself leaves open
    bool either = false;  // seen or refused: both are right
    bool sound = true;    // the contour determines it: else the only right answer is a refusal

    void turn(double deg, const Vector2d& shift) {
        for (Sheet& sheet : sheets)
            for (Vector2d& p : sheet) p = turned(p, rad(deg)) + shift;
        truth = turned(truth, rad(deg)) + shift;
        slope_deg += deg;
    }
    // The other way round: left is right.
    void mirror() {
        for (Sheet& sheet : sheets)
            for (Vector2d& p : sheet) p.x() = -p.x();
        truth.x() = -truth.x();
        slope_deg = -slope_deg;
        auto& v = recipe.parameters;
        for (double& x : recipe.template_profile.x_mm) x = -x;
        recipe.template_reference_mm.x() = -recipe.template_reference_mm.x();
        if (recipe.kind == "contour-end") v["side"] = v.contains("side") && v["side"] == 1 ? 0 : 1;
        const bool from = v.contains("window_x_min_mm"), to = v.contains("window_x_max_mm");
        const double a = v["window_x_min_mm"], b = v["window_x_max_mm"];
        v.erase("window_x_min_mm");
        v.erase("window_x_max_mm");
        if (to) v["window_x_min_mm"] = -b;
        if (from) v["window_x_max_mm"] = -a;
    }
    // By a sensor whose z points away from it. The sheets stay, the profile and what is asked of it are turned over.
    void look_down() {
        sensor.down = true;
        truth.y() = -truth.y();
        slope_deg = -slope_deg;
        auto& v = recipe.parameters;
        const auto swap = [&](const char* name, double highest, double lowest) {
            const auto at = v.find(name);
            if (at == v.end()) return;
            at->second = at->second == highest ? lowest : at->second == lowest ? highest : at->second;
        };
        if (recipe.kind == "contour-end") swap("segment", 2, 3);
        if (recipe.kind == "corner") swap("which", 1, 2);
        if (recipe.kind == "extremum") v["which"] = v.contains("which") && v["which"] == 1 ? 0 : 1;
        for (double& z : recipe.template_profile.z_mm) z = -z;
        recipe.template_reference_mm.y() = -recipe.template_reference_mm.y();
    }
    void window(double from, double to) {
        recipe.parameters["window_x_min_mm"] = from;
        recipe.parameters["window_x_max_mm"] = to;
    }
    Profile profile(Dice& dice) const { return seen(sheets, sensor, dice); }
    // Advance of the contour from line to line there.
    double step() const { return sensor.pitch / std::cos(rad(slope_deg)); }
};

// The sheets below end on their right, at about the origin, and begin far outside of the field on the left.
inline constexpr double kFar = 400;

inline Scene at_random_place(Scene s, Dice& dice, double most_tilt_deg) {
    const double room = 0.45 * s.sensor.half_field();
    s.turn(dice.uniform(-most_tilt_deg, most_tilt_deg), {dice.uniform(-room, room), dice.uniform(-40, 40)});
    return s;
}
inline Scene end_on_the_right(Dice& dice) {
    Scene s;
    s.sensor = SensorModel::any(dice);
    s.recipe.kind = "contour-end";
    s.recipe.parameters["side"] = 1;
    return s;
}

inline Scene bare_edge(Dice& dice) {
    Scene s = end_on_the_right(dice);
    s.sheets = {{{-kFar, 0}, {0, 0}}};
    return at_random_place(s, dice, 25);
}
// A sheet that reaches beyond the field: a door that hangs off.
inline Scene edge_out_of_field(Dice& dice) {
    Scene s = end_on_the_right(dice);
    s.sheets = {{{-kFar, 0}, {0, 0}}};
    s.turn(dice.uniform(-15, 15), {0, 0});
    s.turn(0, {s.sensor.half_field() + dice.uniform(0.5, 12), 0});
    if (dice.chance(0.3)) s.sheets[0][0] = s.sheets[0][1] - Vector2d(1.4 * s.sensor.half_field(), 0);
    s.sound = false;
    return s;
}
// The step of a lap, large enough that nobody can take it for noise, nor for a flank of 65 degrees where an
// interpolated line stands in it.
inline double lap_step(const SensorModel& s, Dice& dice) {
    return std::max({dice.uniform(0.5, 2), 8 * s.noise, (s.grid == Grid::resampled ? 4.5 : 1.5) * s.pitch});
}
inline Scene lap(Dice& dice, const char* meant) {
    Scene s = end_on_the_right(dice);
    const double step = lap_step(s.sensor, dice);
    const std::string which = meant;
    const bool lower_ends = which != "highest" || dice.chance(0.5);
    const double lower_end = lower_ends ? dice.uniform(5, 0.4 * s.sensor.half_field()) : kFar;
    s.sheets = {{{-kFar, 0}, {0, 0}}, {{-20, -step}, {lower_end, -step}}};
    if (which == "lowest") s.truth = {lower_end, -step};
    s.sound = which != "default";
    if (which == "highest") s.recipe.parameters["segment"] = 2;
    if (which == "lowest") s.recipe.parameters["segment"] = 3;
    return at_random_place(s, dice, 10);
}
inline Scene rounded_rim(Dice& dice, double least, double most) {
    Scene s = end_on_the_right(dice);
    const double radius = dice.uniform(least, most), bend = dice.uniform(30, 60);
    Sheet sheet{{-kFar, 0}, {-radius * std::sin(rad(bend)), 0}};
    roll(sheet, 0, -bend, radius);
    s.truth = sheet.back();
    s.slope_deg = -bend;
    s.sheets = {sheet};
    return at_random_place(s, dice, 10);
}
// Two sheets with nothing in between; the window is about the left one's rim.
inline Scene gap_rim(Dice& dice, double least, double most, double most_flush) {
    Scene s = end_on_the_right(dice);
    // What a few lines of noise or of missing returns could be is no gap to anybody.
    const double width = std::max(dice.uniform(least, most), 12 * s.sensor.pitch + 6 * s.sensor.noise);
    const double flush = dice.uniform(-most_flush, most_flush);
    s.sheets = {{{-kFar, 0}, {0, 0}}, {{width, flush}, {kFar, flush}}};
    s = at_random_place(s, dice, 10);
    const double before = dice.uniform(4, 10), behind = dice.uniform(0.5 * width, width + 8);
    // Not up to the field's rim, where the window would hold another contour's lost end.
    s.window(s.truth.x() - before, std::min(s.truth.x() + behind, 0.9 * s.sensor.half_field()));
    return s;
}
inline Scene window_before_the_end(Dice& dice) {
    Scene s = bare_edge(dice);
    const double cut = s.truth.x() - dice.uniform(1, 8);
    s.window(cut - 15, cut);
    s.sound = false;
    return s;
}

inline Scene corner_scene(Dice& dice) {
    Scene s;
    s.sensor = SensorModel::any(dice);
    s.recipe.kind = "corner";
    return s;
}
inline Scene bend(Dice& dice, bool rounded) {
    Scene s = corner_scene(dice);
    const double turn = dice.uniform(20, 110) * (dice.chance(0.5) ? 1 : -1);
    const double radius = rounded ? dice.uniform(0.5, 3) : 0,
                 back = radius * std::tan(rad(std::abs(turn) / 2));
    Sheet sheet{turned({-kFar, 0}, rad(-turn / 2)), turned({-back, 0}, rad(-turn / 2))};
    if (rounded) roll(sheet, -turn / 2, turn, radius);
    go(sheet, turn / 2, kFar);
    s.sheets = {sheet};
    if (rounded) s.recipe.parameters["blend_mm"] = std::min(1.3 * back, 6.) + 0.2;
    s = at_random_place(s, dice, 8);
    if (dice.chance(0.5)) s.window(s.truth.x() - dice.uniform(10, 14), s.truth.x() + dice.uniform(10, 14));
    return s;
}
// 60 or 90 degrees, between two plates. In a window about its ground, the lowest of its corners, or neither.
inline Scene groove(Dice& dice, const char* meant) {
    Scene s = corner_scene(dice);
    const double open = dice.chance(0.5) ? 60 : 90, depth = dice.uniform(5, 12);
    const double half = depth * std::tan(rad(open / 2));
    s.sheets = {{{-kFar, depth}, {-half, depth}, {0, 0}, {half, depth}, {kFar, depth}}};
    s = at_random_place(s, dice, 4);
    const std::string which = meant;
    if (which == "window") s.window(s.truth.x() - 0.6 * half, s.truth.x() + 0.6 * half);
    if (which == "lowest") s.recipe.parameters["which"] = 2;
    s.sound = which != "default";
    return s;
}
// A plate with a web that leans by up to twenty degrees, seen with its flank of 70 to 80 degrees.
inline Scene t_joint(Dice& dice) {
    Scene s = corner_scene(dice);
    const double flank = dice.uniform(70, 80), height = dice.uniform(8, 20);
    Sheet sheet{{-kFar, 0}, {0, 0}};
    go(sheet, flank, height);
    go(sheet, 0, dice.uniform(1.5, 4));
    s.sheets = {sheet, {{0, 0}, {kFar, 0}}};
    s.turn(dice.uniform(-3, 1), {0, 0});
    s.turn(0, {dice.uniform(-8, 8), dice.uniform(-20, 20)});
    s.window(s.truth.x() - 10, s.truth.x() + 0.8 * height * std::cos(rad(flank)));
    return s;
}
// Two bends that look alike.
inline Scene z_fold(Dice& dice) {
    Scene s = corner_scene(dice);
    const double turn = dice.uniform(25, 65), length = dice.uniform(6, 14);
    Sheet sheet{{-kFar, 0}, {0, 0}};
    go(sheet, turn, length);
    go(sheet, 0, kFar);
    s.sheets = {sheet};
    s.sound = false;
    return at_random_place(s, dice, 5);
}

// A block with flanks of `slope` degrees; how many of their points a filter may not throw away.
struct Flanks {
    Profile profile;
    std::vector<int> of_flank;  // lines, without the two next to an edge
};
inline Flanks flanks(const SensorModel& sensor, double slope_deg, int points, Dice& dice) {
    const double run = points * sensor.pitch, height = run * std::tan(rad(slope_deg));
    const double half = dice.uniform(5, 10), left = -half - run, right = half + run;
    const std::vector<Sheet> sheets{
        {{-kFar, 0}, {left, 0}, {-half, height}, {half, height}, {right, 0}, {kFar, 0}}};
    Flanks f;
    SensorModel s = sensor;
    s.steepest_deg = 89;
    s.reversed = false;
    f.profile = seen(sheets, s, dice);
    for (int i = 0; i < s.points; ++i) {
        const double x = std::abs(-s.half_field() + s.pitch * (i + 0.5));
        if (x > half + 2 * s.pitch + 3 * s.noise && x < half + run - 2 * s.pitch - 3 * s.noise &&
            std::isfinite(f.profile.z_mm[std::size_t(i)]))
            f.of_flank.push_back(i);
    }
    return f;
}

struct Tally {
    int right = 0, refused = 0, wrong = 0;
    void add(const Scene& s, const Feature& f) {
        if (f.status != FeatureStatus::ok) {
            ++(s.sound && !s.either ? refused : right);
            return;
        }
        ++(s.sound && is_right(s, f) ? right : wrong);
    }
    // Nearer than what pitch and noise make of it, or than five times what the answer says of itself.
    static bool is_right(const Scene& s, const Feature& f) {
        const double error = (f.point_mm - s.truth).norm();
        const double stated = std::sqrt(f.covariance_mm2.trace());
        return error <= 2 * s.step() + 4 * s.sensor.noise + s.loose_mm || error <= 5 * std::min(stated, 0.3);
    }
    int all() const { return right + refused + wrong; }
};

}  // namespace seamwright::scenes
