#pragma once
// One guided calibration from its first capture to the calibration in use. It grows on disk with every
// capture and every tick, so that a killed program loses nothing, and it needs no screen.
//
// Folder. FILE.seam.calibration/<sensor>-<method>/, or with -2, -3 where that is another robot's or another sensor's of
// a like name, holds session.json (settings, order and marks of the captures, which calibration came of it),
// captures/<id>.json (one capture, never changed), captures/<id>.png where a picture was taken, and result.json (the
// newest solution and what it was solved from). Each file is written whole or not at all, a capture before the list
// that names it. begin_anew() keeps the finished session beside, under its time.
//
// Marks. `left_out`: the engineer took the pose out; its residual is still given. `verification`: never
// solved with; it judges the solution, see verify().

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/ids.h"
#include "core/text.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/model/project.h"

namespace seamwright {

struct CalibrationCapture {
    std::string id;                           // "P1"; unique in the session, never used again
    std::string taken_utc;                    // ISO 8601
    std::string origin;                       // "live", or the file it was read from
    std::optional<Pose> base_from_flange;     // as the robot reported it
    nlohmann::json entry;                     // as the method's data hold it
    std::string picture;                      // image file, in the session's folder or absolute; empty: none
    std::string sensor_serial, robot_serial;  // of the devices that it was taken with; empty: not known
};

struct SessionCapture {
    std::shared_ptr<const CalibrationCapture> taken;
    bool left_out = false;
    bool verification = false;
    bool operator==(const SessionCapture&) const = default;
};

// Whose chain a capture of CaptureKind::board_chain is: "sensor" of its entry, which add() writes, else the
// sensor it is called after.
const std::string& sensor_of_chain(const CalibrationCapture& capture);

// What undo and redo exchange.
struct SessionState {
    nlohmann::json settings = nlohmann::json::object();  // the method's data without the list
    std::vector<SessionCapture> captures;
    bool operator==(const SessionState&) const = default;
};

// What is next; derived.
enum class SessionStage { prepare, capture, solve, verify, use, used };

inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// One line of the list of poses. Parts that the method does not have are NaN.
struct PoseRow {
    std::string id;
    double rms_mm = kNone, deg = kNone, rms_px = kNone;
    bool left_out = false, verification = false;
    bool contradicts = false;  // the solver found it wrong and left it out by itself
    Text note;
};

// Residual of the poses that were not solved with, against what the solution promises.
struct Verification {
    int poses = 0;  // that can confirm
    // Kept back, but the robot stands within 0.5 mm and 0.1 degree of where one was solved with: {kept back, solved with}. It
    // confirms nothing; that it disagrees still counts.
    std::vector<std::pair<std::string, std::string>> repeats;
    bool confirmed = false;
    double worst_mm = kNone, worst_deg = kNone, worst_px = kNone;  // NaN: the method has none
    double limit_mm = kNone, limit_deg = kNone, limit_px = kNone;
};

class CalibrationSession {
  public:
    // The unfinished or finished session of this sensor and method, or a new one. Error (file): the folder
    // cannot be written, a session.json that is none. A capture file that is missing or damaged is left out
    // of the list and named in notices(). `robots`, `sensors`: the project's; what was captured with another of them is that
    // one's session, and what was with a robot that is none of them goes on, the robot has another name now.
    static Expected<CalibrationSession> open(const std::filesystem::path& project_file,
                                             const MethodId& method, const SensorId& sensor,
                                             const RobotId& robot,
                                             const std::vector<std::string>& robots = {},
                                             const std::vector<std::string>& sensors = {});
    static std::filesystem::path folder_of(const std::filesystem::path& project_file);
    // Sessions go with their project: copied when it is saved under another name, put aside under their time
    // when another project takes the file's place. Nothing to do is no Error.
    static Expected<void> copy_all(const std::filesystem::path& from_project,
                                   const std::filesystem::path& to_project);
    static Expected<void> put_aside(const std::filesystem::path& project_file);
    // True when open() would find captures.
    static bool exists(const std::filesystem::path& project_file, const MethodId& method,
                       const SensorId& sensor, const std::vector<std::string>& sensors = {});
    // All sessions of the project say from here on that the device is called `to`, chains of a gripper's shot with them. What
    // a sensor of that name has left that is gone is put aside. A session that is open: renamed().
    static Expected<void> rename_sensor(const std::filesystem::path& project_file, const std::string& from,
                                        const std::string& to, const std::vector<std::string>& other_sensors);
    static Expected<void> rename_robot(const std::filesystem::path& project_file, const std::string& from,
                                       const std::string& to);
    // This one, after rename_sensor() or rename_robot(); not where captures name sensors (board_chain): open() that anew.
    void renamed(const std::string& sensor, const std::string& robot);

    const CalibrationMethod& method() const { return *method_; }
    const std::string& sensor_id() const { return sensor_id_; }
    const std::string& robot_id() const { return robot_id_; }
    const std::filesystem::path& folder() const { return folder_; }
    const SessionState& state() const { return state_; }
    const std::vector<Text>& notices() const { return notices_; }

    // Every edit is on disk when it returns; an Error changes nothing.
    Expected<void> set_state(SessionState state);
    // An entry without id gets a free one; an id that is taken is extended. A chain takes the place of the
    // one that its sensor has; without id it is of the session's own sensor. A picture beside the session is
    // the caller's to write before, at free_picture_path().
    Expected<std::string> add(CalibrationCapture capture, bool verification = false);
    Expected<void> leave_out(const std::string& id, bool left_out);
    Expected<void> set_verification(const std::string& id, bool verification);
    Expected<void> remove(const std::string& id);
    Expected<void> set(const std::string& setting, double value);
    Expected<void> set_settings(nlohmann::json settings);
    std::string free_id() const;
    std::filesystem::path free_picture_path(const std::string& id) const;       // empty id: for free_id()
    std::filesystem::path picture_of(const CalibrationCapture& capture) const;  // empty: none

    // The method's data of all captures, those not to solve with named by exclude().
    nlohmann::json data() const;
    std::vector<std::string> exclude() const;
    int solving_captures() const;       // neither left out nor for verification
    int verification_captures() const;  // not left out

    // May run on another thread on a copy of the session; take() then stores it, with the state it was solved
    // from.
    Expected<CalibrationSolution> solve() const;
    Expected<void> take(const CalibrationSolution& solution, const SessionState& solved_from);
    // The solution of exactly this state; nullptr when there is none yet.
    const CalibrationSolution* solution() const;

    std::vector<PoseRow> rows() const;
    Verification verification() const;
    SessionStage stage() const;
    const std::vector<std::string>& used_as() const { return used_as_; }  // calibrations; empty: not used yet
    Expected<void> set_used_as(std::vector<std::string> calibration_ids);
    // The session so far is kept under its time, this one starts empty with the same settings. Returned is the folder
    // that holds it now; empty: there was nothing on disk.
    Expected<std::filesystem::path> begin_anew();
    // Takes up the session that begin_anew() has put aside there, and puts this one aside in its place: `parked` is then
    // this one's folder. Done twice, all is as before. Error (file): nothing is parked there, it cannot be moved or read.
    Expected<void> exchange(std::filesystem::path& parked);

  private:
    CalibrationSession() = default;
    Expected<void> write_list(const SessionState& state, const std::vector<std::string>& used_as) const;
    Expected<void> read();
    const SessionCapture* solved_at_its_place(const SessionCapture& judge) const;

    const CalibrationMethod* method_ = nullptr;
    std::string sensor_id_, robot_id_;
    std::vector<std::string> former_sensors_;  // names that the sensor had
    std::vector<std::string> used_as_;
    std::filesystem::path folder_;
    SessionState state_;
    int last_number_ = 0;  // of the newest "P<n>" ever
    std::optional<CalibrationSolution> solution_;
    SessionState solved_from_;
    std::vector<Text> notices_;
};

}  // namespace seamwright
