#pragma once
// The captures of a guided calibration one after the other: the desk sends the robot to each proposed pose and captures
// there, until the method has as many as it advises and, once the solution serves, one kept back for verification. A
// solution that does not serve then gets kRound more at every further start. No widget.

#include <QObject>
#include <QString>
#include <string>

#include "widgets/desk/calibration_desk.h"

namespace seamwright {

class CalibrationSeries : public QObject {
    Q_OBJECT
  public:
    CalibrationSeries(Desk& desk, CalibrationDesk& calibration, QObject* parent = nullptr);

    static constexpr int kRound =
        3;  // captures that a solution gets that does not serve, or is not confirmed

    // From where the session is. Without a capture and a proposed pose the first one is taken where the robot stands.
    // Does not begin where the robot may not be moved (Desk::go_to). Ends by itself at the first capture that is refused,
    // at a motion that failed, when a solution of all that were wanted does not serve, and when no pose is left: then the
    // newest capture verifies.
    void start();
    void stop();  // the motion under way is done, no other is begun
    bool running() const { return doing_ != Doing::nothing; }
    int wanted() const;  // captures, those kept back with them
    // Poses that start() would go to now; 0: none is left. Before the first capture: all.
    int more() const;
    // Beyond what the method advises, because the solution does not serve or is not confirmed.
    bool extends() const;

  signals:
    void running_changed();

  private:
    enum class Doing { nothing, going, capturing, solving };
    void next();
    void capture();
    void look();  // what has become of the capture
    void set_doing(Doing doing);
    int goal() const;  // captures to solve with, were it started now
    bool verifies() const;
    int kept_back() const;

    Desk& desk_;
    CalibrationDesk& calibration_;
    Doing doing_ = Doing::nothing;
    std::size_t captures_ = 0;  // before the one under way
    int goal_ = 0;              // captures to solve with, of what runs
};

}  // namespace seamwright
