#pragma once
// The thread that owns the Station and talks to the devices; while nothing is asked it lends the sensors to
// LiveSensors and asks the robots for mode and pose twice a second. The screen queues requests and gets values back by
// signals (queued into the receiver's thread). Nothing here blocks the caller, except close().

#include <QObject>
#include <QString>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "core/alignment/alignment.h"
#include "devices/genicam/genicam.h"
#include "projects/acceptance/equipment/measure_robot.h"
#include "projects/acceptance/equipment/measure_trigger.h"
#include "projects/acceptance/study/live_study.h"
#include "projects/calibrate/session/shot.h"
#include "projects/confirm/confirm.h"
#include "projects/panel/gap_check.h"
#include "projects/proof/known_shift.h"
#include "projects/proof/zero_shift.h"
#include "projects/station/light/spot_light.h"
#include "projects/station/station.h"
#include "projects/station/teach.h"
#include "widgets/worker/live_feed.h"
#include "widgets/worker/live_sensors.h"

namespace seamwright {

struct LearntPanel;
struct MeasuredPanel;

struct RobotState {
    std::string id;
    RobotIdentity identity;
    RobotMode mode = RobotMode::unknown;
    std::optional<Pose> base_from_flange;
    bool can_move = false;  // from here (RobotLink::can_move)
    Text trouble;           // why it does not answer
};

struct StationState {
    bool connected = false;
    int connection = 0;  // how often the devices were connected: another number, other links
    std::vector<SensorState> sensors;
    std::vector<RobotState> robots;
    Text trouble;                                 // of the last attempt to connect
    std::chrono::steady_clock::time_point asked;  // when this was so
};

struct LightOfSpot {
    Spot spot;  // as it was
    FoundLight light;
};

// A panel in its gripper: measured, and with `push` moved, in one step or by servoing.
struct PanelOrder {
    std::string job_id, part_id;
    bool push = false, servo = false;
};

class StationWorker : public QObject {
    Q_OBJECT
  public:
    explicit StationWorker(LiveFeed& feed, QObject* parent = nullptr);
    ~StationWorker() override;

    // Of another project: devices are disconnected first. Waits for what runs (cancels it).
    void open(const std::filesystem::path& file, const Project& project);
    void close();
    void use(const Project& project);  // newest wins; counts from the next request

    // Who what is begun from here on is done for; nobody: what needs no person.
    void act_for(std::optional<SignedIn> who);

    void connect_devices();
    void disconnect_devices();
    // Everything that the devices deliver goes into this recording too (nullptr: no more); they connect
    // anew, without a recorder only where they are connected.
    void record_to(const std::shared_ptr<Recorder>& recorder);
    // `part_type`: of the part that stands there; empty where the project has no types.
    void measure(const std::string& part_id, bool push, bool keep_images, const std::string& part_type = {});
    void zero_shift(int runs, const std::string& part_type = {});
    // by_hand: place_part() asks before each displacement, answer_push() answers.
    void known_shift(ShiftBy by, const ShiftGrid& grid, const std::string& part_type = {});
    // Goes on with what was begun (projects/acceptance/study/live_study.h). place_study_part() asks before each part,
    // answer_push() answers; on a simulated cell the simulation puts them in.
    void measure_study(const LiveStudyOptions& options);
    // Measured, not kept: robot_studied(), trigger_studied() bring them.
    void measure_robot(const MeasureRobotOptions& options);
    void measure_trigger(const MeasureTriggerOptions& options);
    void teach(const Spot& draft, int repeats);
    void find_light(const Spot& spot);         // light_found() brings it
    void confirm(const std::string& spot_id);  // from the drawing; confirmed() brings what was found
    // Stop by stop along the spots, or from a capture; gap_passed() brings it.
    void drive_gap(const DrivenGapPass& options);
    void read_gap(const std::filesystem::path& capture, const RecordedGapPass& options);
    // With `push` confirm_panel() asks before the first move, answer_push() answers. panel_moved() tells where it was measured
    // in several moves, panel_measured() ends it; cancelled, the record says so.
    void fit_panel(const PanelOrder& order);
    // Twelve moves, nobody is asked; panel_moved(), then panel_learnt(). What is learnt or taught the document keeps.
    void learn_panel(const std::string& job_id);
    void teach_panel(const std::string& job_id, int repeats);  // panel_taught()
    void record_pass(const Spot& spot, double step_mm, const AlignmentOptions& options);
    // Robot standing still: its pose, the stripe, and with `board` a second image with the laser off, exposed
    // for the surroundings; one sensor after another. An empty robot_id asks no robot. Returned is the number that
    // shots_taken() answers with.
    int take_shots(const std::vector<std::string>& sensor_ids, const std::string& robot_id, bool board);
    // Straight to a place, at the speed that the driver moves with; arrived() tells what became of it. Whether the robot may
    // be moved from the desk is Desk::go_to()'s to ask.
    void go_to(const std::string& robot_id, const Pose& base_from_flange);
    // By hand, step by step, beside the live picture: the newest place asked for counts, those before it are passed over;
    // dropped while something else runs. Any robot that can move from here. jogged() tells what became of it.
    void jog(const std::string& robot_id, const Pose& base_from_flange);
    void stop_jog();        // what was asked for and not begun
    void search_cameras();  // on all networks; cameras_found() brings them
    void set_sensor_parameter(const std::string& sensor_id, const std::string& name, double value);
    void answer_push(bool yes);  // to confirm_push
    void cancel();               // what runs and what waits; connecting and setting are done nevertheless
    bool busy() const;
    // What runs or waits has a result that closing would lose; connecting, searching and setting have none.
    bool losable() const;

  signals:
    // All but busy_changed() are of the project that was opened last: what another's devices still said is dropped.
    void state_changed(std::shared_ptr<const seamwright::StationState> state);
    void busy_changed(bool busy, QString what);
    void progressed(int done, int total, QString text);
    void failed(QString sentence);
    // Where it stands now. `trouble` is empty when it went well.
    void jogged(std::string robot_id, seamwright::Pose base_from_flange, QString trouble);
    // At the end of go_to(); `trouble` is empty when the robot stands there.
    void arrived(std::string robot_id, QString trouble);
    void measured(std::shared_ptr<const seamwright::RunRecord> run);
    void confirm_push(std::shared_ptr<const seamwright::RunRecord> judged);
    void place_part(QString name, seamwright::Pose base_from_shiftedbase);
    void place_study_part(QString part, int rehang);
    void studied(std::shared_ptr<const seamwright::StudyProgress> progress);
    void robot_studied(std::shared_ptr<const seamwright::MeasuredRobot> robot);
    void trigger_studied(std::shared_ptr<const seamwright::MeasuredTrigger> trigger);
    void cameras_found(std::shared_ptr<const std::vector<seamwright::DiscoveredCamera>> cameras);
    void proven();  // an evidence has come into the file
    void taught(std::shared_ptr<const seamwright::TaughtSpot> taught);
    void light_found(std::shared_ptr<const seamwright::LightOfSpot> found);
    void confirmed(std::shared_ptr<const seamwright::Confirmation> confirmation);
    void passed(std::shared_ptr<const seamwright::JudgedPass> pass);
    void gap_passed(std::shared_ptr<const seamwright::GapPass> pass);
    void confirm_panel(std::shared_ptr<const seamwright::RunRecord> judged);
    void panel_moved(std::shared_ptr<const seamwright::PanelRecord> so_far, int moves);
    void panel_measured(std::shared_ptr<const seamwright::MeasuredPanel> panel);
    void panel_learnt(std::shared_ptr<const seamwright::LearntPanel> learnt);
    void panel_taught(std::shared_ptr<const seamwright::PanelJob> taught);
    // What failed is in them: who asked for it says it.
    void shots_taken(std::shared_ptr<const seamwright::CalibrationShots> shots, int number);

  private:
    using Task = std::function<void(Station&, const std::stop_token&)>;
    // From the station's thread. What stands in the queue of the screen's thread when another project is opened would be taken
    // for that one's: a reference for its spot of the same name, its sensor's identity.
    template <class... Said, class... Given>
    void tell(void (StationWorker::*signal)(Said...), Given&&... said) {
        QMetaObject::invokeMethod(
            this,
            [this, signal, of = told_of_, values = std::tuple<Said...>(std::forward<Given>(said)...)] {
                if (of != opened_last_) return;
                std::apply([&](const auto&... value) { emit(this->*signal)(value...); }, values);
            },
            Qt::QueuedConnection);
    }
    enum class Loss { none, result };
    // What is told where there is no station to do it with; none: failed().
    using Unserved = std::function<void(const Error& why)>;
    void post(const QString& what, Task task, Unserved unserved = {});
    void post(Loss loss, const QString& what, Task task, Unserved unserved = {});
    Error no_station() const;
    void take_project(Station& station, const Project& newest);
    void work(const std::stop_token& stop);
    void start_live(Station& station);
    void stop_live();
    void publish(Station& station);
    void attach_feed(Station& station);
    // Asks a person and waits: true for yes; false for no and when cancelled.
    bool ask(const std::stop_token& cancelled, const std::function<void()>& question);
    void run_one(Station& station, const RunOptions& options);
    std::function<void(const RunProgress&)> progress_sink();

    LiveFeed& feed_;
    mutable std::mutex mutex_;
    std::condition_variable_any wake_;
    struct Request {
        QString what;
        Task task;
        std::stop_source cancel;
        Loss loss = Loss::result;
        Unserved unserved;
    };
    void refuse(const Request& request);
    std::deque<Request> queue_;
    struct JogRequest {
        std::string robot_id;
        Pose base_from_flange = Pose::Identity();
    };
    void move_by_hand(Station& station, const JogRequest& request);
    std::optional<JogRequest> jog_request_;
    std::unique_ptr<Project> newest_project_;
    std::optional<SignedIn> who_;
    std::optional<std::pair<std::filesystem::path, Project>> open_request_;
    bool close_request_ = false, busy_ = false, opened_ = false;
    Loss doing_ = Loss::none;  // while busy_
    int opening_ = 0;          // number of the newest open() or close()
    int opened_last_ = 0;      // the same, of the screen's thread alone
    int told_of_ = 0;          // of the station's thread: which of them it works for
    int shots_asked_ = 0;      // of the screen's thread
    std::stop_source cancel_;
    std::optional<bool> push_answer_;
    std::unique_ptr<LiveSensors> live_;
    std::vector<SensorState> sensors_;  // as last seen
    std::optional<Station> station_;
    std::optional<Error> open_trouble_;  // why there is no station although a project is open
    Text connect_trouble_;
    int connection_ = 0;
    std::jthread thread_;
};

}  // namespace seamwright
