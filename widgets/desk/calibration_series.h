#pragma once
// The captures of a guided calibration one after the other: the desk sends the robot to each proposed pose and captures
// there, until the method has as many as it advises and one kept back for verification. No widget.

#include <QObject>
#include <QString>
#include <string>

#include "widgets/desk/calibration_desk.h"

namespace seamwright {

class CalibrationSeries : public QObject {
    Q_OBJECT
  public:
    CalibrationSeries(Desk& desk, CalibrationDesk& calibration, QObject* parent = nullptr);

    // From where the session is. Without a capture and a proposed pose the first one is taken where the robot stands.
    // Does not begin where the robot may not be moved (Desk::go_to). Ends by itself at the first capture that is refused,
    // at a motion that failed, and when no pose is left: then the newest capture verifies.
    void start();
    void stop();  // the motion under way is done, no other is begun
    bool running() const { return doing_ != Doing::nothing; }
    int wanted() const;  // captures, those kept back with them

  signals:
    void running_changed();

  private:
    enum class Doing { nothing, going, capturing, solving };
    void next();
    void capture();
    void look();  // what has become of the capture
    void set_doing(Doing doing);
    bool verifies() const;
    int kept_back() const;

    Desk& desk_;
    CalibrationDesk& calibration_;
    Doing doing_ = Doing::nothing;
    std::size_t captures_ = 0;  // before the one under way
};

}  // namespace seamwright
