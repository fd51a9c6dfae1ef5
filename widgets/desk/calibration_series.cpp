#include "widgets/desk/calibration_series.h"

#include <algorithm>

#include "projects/calibrate/session/guide.h"
#include "projects/calibrate/session/shot.h"

namespace seamwright {

CalibrationSeries::CalibrationSeries(Desk& desk, CalibrationDesk& calibration, QObject* parent)
    : QObject(parent), desk_(desk), calibration_(calibration) {
    connect(&desk_.worker(), &StationWorker::arrived, this,
            [this](const std::string& robot_id, const QString& trouble) {
                if (doing_ != Doing::going || !calibration_.is_open() ||
                    robot_id != calibration_.session().robot_id())
                    return;
                if (!trouble.isEmpty()) return set_doing(Doing::nothing);
                capture();
            });
    // Queued: what was captured is in the session only after the desk has said that it is no longer busy.
    connect(&calibration_, &CalibrationDesk::busy_changed, this, &CalibrationSeries::look,
            Qt::QueuedConnection);
    connect(&desk_, &Desk::station_changed, this, [this] {
        if (!desk_.station().connected) stop();
    });
    connect(&desk_, &Desk::opened, this, &CalibrationSeries::stop);
}

int CalibrationSeries::kept_back() const {
    return calibration_.session().method().keeps_back ? 1 : 0;
}

int CalibrationSeries::wanted() const {
    return goal_ + kept_back();
}

bool CalibrationSeries::extends() const {
    const CalibrationSession& s = calibration_.session();
    if (s.solving_captures() < s.method().advised) return false;
    return (s.solution() && !serves(s.solution()->verdict())) || s.verification_captures() >= kept_back();
}

int CalibrationSeries::goal() const {
    const CalibrationSession& s = calibration_.session();
    return extends() ? s.solving_captures() + kRound : std::max(s.method().advised, s.solving_captures());
}

int CalibrationSeries::more() const {
    const CalibrationSession& s = calibration_.session();
    const int open = goal() - s.solving_captures() + std::max(0, kept_back() - s.verification_captures());
    if (s.state().captures.empty()) return open;
    return std::min(open, static_cast<int>(next_poses(s, known_mounting(s, desk_.project())).size()));
}

bool CalibrationSeries::verifies() const {
    return calibration_.session().solving_captures() >= goal_;
}

void CalibrationSeries::set_doing(Doing doing) {
    if (doing_ == doing) return;
    doing_ = doing;
    emit running_changed();
}

void CalibrationSeries::start() {
    if (running() || !calibration_.is_open() || calibration_.busy()) return;
    goal_ = goal();
    next();
}

void CalibrationSeries::stop() {
    set_doing(Doing::nothing);
}

void CalibrationSeries::next() {
    const CalibrationSession& s = calibration_.session();
    const bool poor = s.solution() && !serves(s.solution()->verdict());
    if (verifies() && (poor || s.verification_captures() >= kept_back())) return set_doing(Doing::nothing);
    const auto place = next_place(s, desk_.project());
    if (!place) {
        if (s.state().captures.empty()) return capture();
        set_doing(Doing::nothing);
        if (poor) return;  // every capture is needed to solve with
        for (const std::string& id : to_keep_back(s, kept_back()))
            (void)calibration_.set_verification(id, true);
        return;
    }
    set_doing(desk_.go_to(s.robot_id(), *place) ? Doing::going : Doing::nothing);
}

void CalibrationSeries::capture() {
    captures_ = calibration_.session().state().captures.size();
    set_doing(Doing::capturing);
    calibration_.capture(verifies());
    if (!calibration_.busy()) stop();  // refused before it began
}

void CalibrationSeries::look() {
    if (doing_ != Doing::capturing && doing_ != Doing::solving) return;
    if (!calibration_.is_open()) return stop();
    if (doing_ == Doing::capturing && calibration_.session().state().captures.size() > captures_)
        set_doing(Doing::solving);
    if (calibration_.busy()) return;
    if (doing_ == Doing::capturing) return stop();  // refused: the page says why
    next();
}

}  // namespace seamwright
