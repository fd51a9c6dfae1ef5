#include "projects/drift/drift_standing.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/acceptance/distributions.h"
#include "devices/capture/capture.h"
#include "projects/drift/drift_point.h"

namespace seamwright {
namespace {

constexpr double kContradiction = 0.001;

bool set_aside(const DriftWatch& watch, std::int64_t point) {
    return std::any_of(watch.set_aside.begin(), watch.set_aside.end(), [&](const SetAside& range) {
        return point >= range.first_point && point <= range.last_point;
    });
}

// A step that nobody has acknowledged, whatever was measured differently since: 0 for none.
std::int64_t open_step(const DriftWatch& watch, std::span<const DriftPoint> points) {
    for (const DriftPoint& p : points)
        if (p.step && !set_aside(watch, p.id) && (!watch.learnt || p.id > watch.learnt->last_point))
            return p.id;
    return 0;
}

bool counts(const DriftWatch& watch, const DriftPoint& p) {
    return watch.learnt && p.mark == watch.learnt->mark && p.id >= watch.learnt->first_point &&
           !set_aside(watch, p.id) && p.values_mm.size() == watch.learnt->directions.size();
}

std::vector<double> residual(const LearntDrift& learnt, const DriftPoint& p) {
    const double cold = cold_share(p.running_s, p.pause_s, learnt.time_constant_s);
    std::vector<double> row;
    for (std::size_t d = 0; d < p.values_mm.size(); ++d)
        row.push_back(p.values_mm[d] - learnt.directions[d].mean_mm - cold * learnt.directions[d].warm_up_mm);
    return row;
}

// The rows of the chart: all that count before the open step, and `newest`.
std::vector<std::vector<double>> rows_of(const DriftWatch& watch, std::span<const DriftPoint> points,
                                         const DriftPoint* newest) {
    std::vector<std::vector<double>> rows;
    const std::int64_t open = open_step(watch, points);
    for (const DriftPoint& p : points)
        if (counts(watch, p) && (open == 0 || p.id < open)) rows.push_back(residual(*watch.learnt, p));
    if (newest) rows.push_back(residual(*watch.learnt, *newest));
    if (rows.size() > kDriftKept)
        rows.erase(rows.begin(), rows.end() - static_cast<std::ptrdiff_t>(kDriftKept));
    return rows;
}

Expected<DriftJudgement> judge_rows(const DriftWatch& watch, const std::vector<std::vector<double>>& rows) {
    std::vector<DriftChannel> channels;
    for (const LearntDirection& d : watch.learnt->directions) channels.push_back({d.sigma_mm, d.stated_mm});
    return judge_drift(rows, channels, {.limit_mm = watch.limit_mm, .degrees = watch.learnt->degrees});
}

Text sentence(const DriftWatch& watch, const DriftJudgement& j) {
    const std::vector<LearntDirection>& directions = watch.learnt->directions;
    const std::string changed = name_of(directions[j.direction]);
    std::size_t worst = 0;
    for (std::size_t d = 1; d < j.level_mm.size(); ++d)
        if (std::abs(j.level_mm[d]) > std::abs(j.level_mm[worst])) worst = d;
    const std::string furthest = name_of(directions[worst]);
    if (j.change == DriftChange::step)
        return Text("a step of {:+.3f} mm in {}: sensor, robot or reference was knocked", j.size_mm, changed);
    if (j.verdict == DriftVerdict::recalibrate)
        return Text("recalibrate: {} stands {:+.3f} mm off its learnt place, the limit is {:.3f} mm",
                    furthest, j.level_mm[worst], watch.limit_mm);
    if (j.change == DriftChange::drift)
        return Text("a drift of {:+.4f} mm a point in {}, {:+.3f} mm since {} points", j.slope_mm, changed,
                    j.size_mm, j.changed);
    if (j.change == DriftChange::unclear)
        return Text("{} has moved by {:+.3f} mm; whether it wanders or was knocked is not told yet", changed,
                    j.size_mm);
    if (j.verdict == DriftVerdict::watch)
        return Text("Nelson's rule {} in {}", j.rules.front().rule,
                    name_of(directions[j.rules.front().direction]));
    return Text("the reference stands where it was learnt, at most {:+.3f} mm off in {}", j.level_mm[worst],
                furthest);
}

Text not_learnt(const Project& project, int points) {
    if (project.drift->learnt)
        return Text(
            "the reference was learnt with other spots, poses or calibrations: learn it again ({} points "
            "are there)",
            points);
    return Text("nothing is learnt yet: {} points are there, {} are needed", points, kDriftLearnPoints);
}

// What is taken off the next run, or why not.
void compensate(const Project& project, DriftStanding& s, double cold) {
    const DriftWatch& watch = *project.drift;
    ActingDrift& a = s.acting;
    a.drifts = watch.drifts;
    const Spot* spot = drift_spot(project, watch.spot_ids.empty() ? "" : watch.spot_ids.front());
    if (spot) a.device_id = watch.drifts == DriftOf::sensor ? spot->sensor_id : spot->robot_id;
    if (!watch.compensate) {
        for (std::size_t d = 0; spot && d < s.level_mm.size(); ++d)
            a.standing_mm = std::max(a.standing_mm, std::hypot(s.level_mm[d], s.level_sigma_mm[d]));
        return;
    }
    if (s.stopped) {
        a.why = Text("a step is never compensated");
    } else if (s.level_mm.empty()) {
        a.why = Text("nothing is learnt");
    } else if (s.old) {
        a.why = Text("the last point is {} parts or {:.0f} minutes old", s.parts_since, s.minutes_since);
    } else if (spot) {
        std::vector<double> level = s.level_mm;
        for (std::size_t d = 0; d < level.size(); ++d)
            level[d] += cold * watch.learnt->directions[d].warm_up_mm;
        const auto shift = drift_shift(project, watch, level, s.level_sigma_mm);
        if (!shift) {
            a.why = shift.error().text();
        } else if (shift->probability < kContradiction) {
            a.why = watch.drifts == DriftOf::sensor ? Text("the references contradict a shift of the sensor")
                                                    : Text("the references contradict a shift of the robot");
        } else if (shift->shift_mm.norm() > watch.most_mm) {
            s.trouble =
                Text("the drift of {:.3f} mm is beyond what may be compensated, {:.3f} mm: recalibrate",
                     shift->shift_mm.norm(), watch.most_mm);
            a.why = s.trouble;
        } else {
            a.compensated = true;
            a.shift_mm = shift->shift_mm;
            a.sigma_mm = shift->sigma_mm;
        }
    } else {
        a.why = Text("its spots are not in the project");
    }
}

double exact_seconds(const std::string& utc) {
    return static_cast<double>(utc_seconds(utc).value_or(0));
}

}  // namespace

std::string name_of(const LearntDirection& direction) {
    return std::string(direction.axis == 0 ? "X" : "Z") + " of " + direction.spot_id;
}

void judge_point(const Project& project, std::span<const DriftPoint> points, DriftPoint& newest) {
    const DriftWatch& watch = *project.drift;
    newest.verdict = DriftVerdict::learning;
    newest.step = false;
    if (!watch.learnt || newest.mark != watch.learnt->mark ||
        newest.values_mm.size() != watch.learnt->directions.size()) {
        const auto alike = std::count_if(points.begin(), points.end(), [&](const DriftPoint& p) {
            return p.mark == newest.mark && !set_aside(watch, p.id);
        });
        newest.text = not_learnt(project, static_cast<int>(alike) + 1);
        return;
    }
    const auto judged = judge_rows(watch, rows_of(watch, points, &newest));
    if (!judged) {
        newest.text = judged.error().text();
        return;
    }
    newest.verdict = judged->verdict;
    newest.step = judged->change == DriftChange::step;
    newest.changed = newest.step ? static_cast<int>(judged->changed) : 0;
    newest.text = sentence(watch, *judged);
}

DriftStanding drift_standing(const Project& project, std::span<const DriftPoint> points,
                             const std::string& now_utc, std::int64_t parts_since) {
    DriftStanding s;
    if (!project.drift) return s;
    const DriftWatch& watch = *project.drift;
    s.watched = true;
    s.parts_since = parts_since;
    const auto mark = watch.learnt ? watch.learnt->mark : points.empty() ? 0 : points.back().mark;
    const DriftPoint* last = nullptr;
    for (const DriftPoint& p : points)
        if (p.mark == mark && !set_aside(watch, p.id)) {
            ++s.points;
            last = &p;
        }
    if (last) {
        s.last_utc = last->utc;
        s.minutes_since = std::max(0.0, exact_seconds(now_utc) - exact_seconds(last->utc)) / 60;
    }
    const auto over = [&](int times) {
        return !last || (watch.every_parts > 0 && parts_since >= times * watch.every_parts) ||
               (watch.every_minutes > 0 && s.minutes_since >= times * watch.every_minutes);
    };
    s.due = over(1);
    s.old = over(2);
    s.stopped_by = open_step(watch, points);
    s.stopped = s.stopped_by != 0;
    const auto rows = watch.learnt ? rows_of(watch, points, nullptr) : std::vector<std::vector<double>>{};
    if (rows.empty()) {
        s.text = not_learnt(project, s.points);
    } else if (const auto judged = judge_rows(watch, rows)) {
        s.verdict = judged->verdict;
        s.text = sentence(watch, *judged);
        s.level_mm = judged->level_mm;
        s.level_sigma_mm = judged->level_sigma_mm;
        s.rules = judged->rules;
        s.change = judged->change;
    } else {
        s.text = judged.error().text();
    }
    if (s.stopped) {
        s.verdict = DriftVerdict::step;
        s.change = DriftChange::step;
        for (const DriftPoint& p : points)
            if (p.id == s.stopped_by) s.text = p.text;
        s.trouble =
            Text("the drift watch stopped production: {}; a person looks at it and acknowledges", s.text);
    }
    s.acting.verdict = s.verdict;
    s.acting.text = s.text;
    compensate(
        project, s,
        last && watch.learnt ? cold_share(last->running_s, last->pause_s, watch.learnt->time_constant_s) : 0);
    return s;
}

Expected<DriftShift> drift_shift(const Project& project, const DriftWatch& watch,
                                 std::span<const double> level_mm, std::span<const double> sigma_mm) {
    const Text where("drift watch");
    if (!watch.learnt || level_mm.size() != watch.learnt->directions.size() ||
        sigma_mm.size() != level_mm.size())
        return input_error("nothing is learnt", where, "learn first: drift FILE.seam learn");
    const auto m = static_cast<Eigen::Index>(level_mm.size());
    Eigen::MatrixX3d a(m, 3);
    Eigen::VectorXd b(m);
    for (Eigen::Index i = 0; i < m; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const LearntDirection& direction = watch.learnt->directions[k];
        Eigen::Vector3d row = Eigen::Vector3d::Unit(direction.axis);
        if (watch.drifts == DriftOf::robot) {
            const Spot* spot = drift_spot(project, direction.spot_id);
            const Calibration* used = nullptr;
            for (const SensorSetup& sensor : project.sensors)
                for (const Calibration& c : project.calibrations)
                    if (spot && sensor.id == spot->sensor_id && c.id == sensor.calibration_id) used = &c;
            if (!used) return input_error("its spots have no calibration", where, "calibrate their sensor");
            row = (spot->base_from_flange * used->flange_from_sensor).linear() * row;
        }
        if (!(sigma_mm[k] > 0) || !std::isfinite(level_mm[k]))
            return input_error("a level or its sigma is no number", where, "learn again");
        a.row(i) = row.transpose() / sigma_mm[k];
        b[i] = level_mm[k] / sigma_mm[k];
    }
    const Eigen::Matrix3d information = a.transpose() * a;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
    DriftShift out;
    int shown = 0;
    for (int k = 0; k < 3; ++k) {
        const double value = eigen.eigenvalues()[k];
        if (value < 1e-6 * eigen.eigenvalues().maxCoeff()) continue;
        ++shown;
        const Eigen::Vector3d v = eigen.eigenvectors().col(k);
        out.shift_mm += v * (v.dot(a.transpose() * b) / value);
        out.sigma_mm = std::max(out.sigma_mm, 1 / std::sqrt(value));
    }
    if (m > shown)
        out.probability =
            1 - chi_square_cdf(static_cast<double>(m - shown), (b - a * out.shift_mm).squaredNorm());
    return out;
}

}  // namespace seamwright
