#pragma once
// A guided calibration at the desk: the session (projects/calibrate/session/session.h) with the devices, undo and
// redo, solving in the background and looking at the live picture for the target. No widget.
//
// Solving starts by itself with every change once there are captures enough, and again when something changed
// meanwhile; cancel() drops what runs. Captures come by capture(), by load(), or by themselves when
// `automatic` is on, the robot has stood still for kStillSeconds at a new place and the target is seen.

#include <QElapsedTimer>
#include <QObject>
#include <QUndoStack>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "core/ids.h"
#include "projects/calibrate/detect_convention.h"
#include "projects/calibrate/session/capture.h"
#include "projects/calibrate/session/guide.h"
#include "widgets/desk/desk.h"

namespace seamwright {

// What the newest live frame shows of the target.
struct LiveTarget {
    EntryPicture picture;  // empty points: nothing was seen
    FramePtr frame;
    bool seen = false;  // a sphere: in two frames one after the other, at the same place
    QString words;      // what is not seen, and what to change
};

class CalibrationDesk : public QObject {
    Q_OBJECT
  public:
    explicit CalibrationDesk(Desk& desk, QObject* parent = nullptr);
    ~CalibrationDesk() override;

    // The session of this method, sensor and its robot: resumed where there is one.
    Expected<void> open(const MethodId& method, const SensorId& sensor, const RobotId& robot);
    void close();
    bool is_open() const { return session_.has_value(); }
    const CalibrationSession& session() const { return *session_; }
    QUndoStack& undo_stack() { return undo_; }
    // The calibration in use at the session's sensor; nullptr: none.
    const Calibration* base() const;
    // Whose pictures one capture takes, the session's own sensor first: that alone, or, where every capture
    // is a sensor's chain, all that are connected and know their camera and robot, the session's.
    std::vector<std::string> shot_sensors() const;
    // flange_from_sensor as far as known: given by the drawing, of the calibration in use, or as a simulated
    // cell is built.
    std::optional<Pose> mounting() const;

    // --- undoable edits
    Expected<void> leave_out(const std::string& id, bool left_out);
    Expected<void> set_verification(const std::string& id, bool verification);
    Expected<void> remove(const std::string& id);
    Expected<void> set(const std::string& setting, double value);
    Expected<void> set_nominal_mounting(const Pose& flange_from_sensor);
    // One standard deviation of an arrival, an axis; mm 0: not stated. Error (input): out of range.
    Expected<void> state_repeatability(double mm, double deg);

    // --- asynchronous; refused() says why not
    void capture(bool verification);
    void load(const std::filesystem::path& path);
    void solve();
    // Asks in which convention the poses are written (projects/calibrate/detect_convention.h); convention() then answers.
    void detect_convention();
    void cancel();
    bool busy() const { return !doing_.isEmpty(); }
    const QString& doing() const { return doing_; }

    void set_automatic(bool on);
    bool automatic() const { return automatic_; }
    double stillness() const { return stillness_; }  // 0 moving .. 1 stood still long enough
    void set_looking(bool on);                       // only while a page shows it
    const LiveTarget& live() const { return live_; }
    bool switches_laser()
        const;  // the sensor takes a board's picture with its laser off, when it is captured

    // Of exactly these captures and marks; nullptr: not asked. Nothing takes it but take_convention(), which is undoable.
    const ConventionAnswer* convention() const;
    Expected<void> take_convention();
    // Worth asking: the method can tell, and its solution is poor or open for no reason that the poses show.
    bool convention_in_doubt() const;

    // The session's answer into the project, undoable there: all its calibrations or none are kept, and with
    // `use` put to use. Error: not verified, nothing solved, a sensor that the project does not know.
    Expected<void> finish(bool use);
    Expected<void> begin_anew();  // undoable

  signals:
    void changed();  // captures, marks, settings, solution
    void busy_changed();
    void progressed(int done, int total);
    void looked();
    void still_changed();
    void refused(QString sentence);

  private:
    using Job = std::function<void(const std::stop_token&)>;
    void post(Job job);
    void work(const std::stop_token& stop);
    void push(const QString& text, const SessionState& before);
    void take_shots(const std::shared_ptr<const CalibrationShots>& shots, int number);
    void take_captures(std::vector<CalibrationCapture> captures, nlohmann::json settings, bool verification,
                       const QString& text);
    void solve_when_due();
    void look();
    std::optional<Pose> robot_pose() const;  // of the session's robot, as last told
    Expected<nlohmann::json> capture_settings() const;
    void watch_robot();
    void exchange(std::filesystem::path& parked);
    void follow(const std::string& sensor, const std::string& robot);
    void set_doing(const QString& what);
    Expected<void> edited(Expected<void> done, const QString& text, const SessionState& before);

    Desk& desk_;
    std::optional<CalibrationSession> session_;
    QUndoStack undo_;
    QString doing_;
    bool waiting_for_shot_ = false, shot_verifies_ = false, solving_ = false, solve_again_ = false,
         automatic_ = false, looking_ = false;
    bool look_pending_ = false;
    int shots_number_ = 0;  // what is waited for; the answer to a capture that was cancelled comes too
    std::uint64_t generation_ = 0;  // of the session: results of an older one are dropped
    std::uint64_t looked_number_ = 0;
    LiveTarget live_;
    std::optional<Eigen::Vector3d> circle_;  // of the sphere in the frame before: x, z, radius
    double stillness_ = 0;
    std::optional<ConventionAnswer> convention_;
    SessionState convention_of_;
    std::optional<Pose> last_pose_;
    QElapsedTimer still_since_;
    std::stop_source cancel_;

    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::deque<std::pair<Job, std::stop_token>> jobs_;  // the token is that of its posting
    std::jthread thread_;
};

}  // namespace seamwright
