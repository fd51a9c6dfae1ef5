#pragma once
// The station: an open project, its devices, and the run measure -> correct -> gate -> push -> read back ->
// record -> release. The command line and the screen call the same functions.
//
// File, robot and verdict agree at every instant. In this order, each durable in the file before the next:
//   judged          the run as measured and judged, `interrupted`
//   each frame      the attempt; written and read back; the push
//   pushed          the run as `pushed`, Release::given: only now may a robot be told
//   corrected       the robots are told; the link is held until their application has taken the permission
//   outcome         `ok`, or `not_taken`/`alarm` with the permission taken back and the old frames restored
// What cannot be written before `pushed` takes the old frames back; nobody was allowed to run. A program that
// ends between `pushed` and the outcome leaves a run that says so; the next connect() asks the robots what
// became of it (Release) and records that.

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>

#include "core/text.h"
#include "devices/capture/recorder.h"
#include "devices/registry.h"
#include "projects/drift/drift_standing.h"
#include "projects/file/project_file.h"
#include "projects/gate/release.h"
#include "projects/station/acquire.h"

namespace seamwright {

struct RunProgress {
    int done = 0, total = 0;  // spots
    Text text;                // "S3 measured", "region left: pushed"
};

struct RunOptions {
    std::string part_id;    // empty = "run <number>"
    std::string part_type;  // id or number of its type, where the project has types (called_type())
    std::string paint;      // as SpotLight::paints names it; empty: not said
    // The robot that called for the part and waits for what becomes of it: it is told even where measuring never
    // began (a sensor cannot be started), and where it has no spot of its own. Empty: those that measured are told.
    std::string caller = {};
    bool push = false;         // false = dry run: everything but writing
    bool keep_images = false;  // raw images with the run, beside candidates and profiles
    AcquireLimits limits;
    // Heard within kCancelSlice until the first frame is written, and again while an application is waited
    // for.
    std::stop_token cancel;
    std::chrono::milliseconds hold = kHold;  // see HoldOptions
    std::function<bool()> part_over = {};    // see HoldOptions
    // A robot that did not acknowledge how the part ended (refused or failed): it may wait for that still.
    std::function<void(const std::string& robot_id, PartVerdict verdict)> untold = {};
    // Its program took the start of measuring.
    std::function<void(const std::string& robot_id)> robot_goes = {};
    std::function<void(const RunProgress&)> progress;  // called on the running thread
    // A person's word before a push run writes: called on the running thread when every region has passed the
    // gate, with the judged run, which is in the file already, and in each RegionRecord::push.before the
    // frame that the controller holds now (absent where it could not be read). false ends the run as
    // cancelled; after true the gate judges once more. Absent: pushed without asking.
    std::function<bool(const RunRecord& judged)> confirm_push = {};
};

// ProjectFile::edits_of_others() that a run rests on: all but those of the line, the drift watch, the fixture and the fleet.
Expected<std::vector<EditOfOthers>> measuring_edits(const ProjectFile& file);

// One thread at a time.
class Station {
  public:
    static Expected<Station> open(const std::filesystem::path& path,
                                  FileAccess access = FileAccess::read_write);
    explicit Station(ProjectFile file, Project project);
    Station(Station&&) noexcept;
    Station& operator=(Station&&) noexcept;
    ~Station();

    const Project& project() const;
    ProjectFile& file();
    // Saves, then takes over. Devices stay as connected; connect() again after changing their settings.
    Expected<void> edit(const Project& project);
    // Takes over what others have edited in the file since it was opened (measuring_edits), and says what. Where devices or their
    // settings are among it the station is disconnected: connect() again. A part that was begun before such an edit is
    // refused by the gate.
    Expected<std::vector<EditOfOthers>> follow_file();
    // Takes over without saving, for an editor whose document is saved by its own command: runs keep the
    // setup they were made with in any case. A connected device that has only another name there goes on under that; where
    // one is gone, and where names change while it is recorded, the station is disconnected.
    void use(const Project& project);

    // Opens every device of the project through the registry and notes who answered in the project
    // (SensorSetup::identity, RobotSetup::identity). All or nothing. Real devices are refused while another
    // program has those of this file (projects/file/file_use.h). A run that was left as `pushed` gets its
    // outcome. A sensor that another program still controls is waited for as `patience` says.
    Expected<void> connect(const Patience& patience = {});
    // The same with devices made elsewhere (tests, a simulation already running).
    void connect(std::map<std::string, std::unique_ptr<ProfileSource>> sensors,
                 std::map<std::string, std::unique_ptr<RobotLink>> robots);
    // Everything that devices deliver from the next connect() on goes into this recording too (nullptr: no
    // more).
    void record_to(std::shared_ptr<Recorder> recorder);
    void disconnect();
    bool connected() const;
    ProfileSource* sensor(const std::string& id);  // nullptr when not connected
    RobotLink* robot(const std::string& id);

    // One part; robots measure one after the other, and each is told the verdict at the end
    // (RobotLink::confirm). Device failures and cancelling end in the record's status (with what was measured
    // until then), never with anything half-written; nothing is pushed before all regions are judged. The
    // record is in the file when this returns. RunStatus::ok of a push: the application runs in the frames,
    // and the link may end. The one record that may be newer than the file: of an application that began
    // while the file could not be written any more, which leaves it `pushed`; an event of the record says so.
    // Error: not connected, a part type that called_type() refuses, no enabled spot of it, a recipe that cannot be prepared, findings of check() that
    // concern motion, the file.
    Expected<RunRecord> run(const RunOptions& options);
    // What the drift watch says after the last run of this station (projects/drift/drift_standing.h).
    const DriftStanding& drift() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
