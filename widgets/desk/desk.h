#pragma once
// The open project as a document: every edit validated and undoable, saved on demand, kept against crashes in
// between, measured with as it stands on the screen.
//
// Files. Save writes the project file. Until then every edit goes to FILE.seam.recovery at once (recovery.h).
// Runs and events are in the project file as soon as they are finished, with the setup they were made with.
// A file that another desk has open is refused (projects/file/file_use.h).

#include <QObject>
#include <QUndoStack>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>

#include "core/ids.h"
#include "projects/file/file_use.h"
#include "projects/reuse/reteach.h"
#include "widgets/aside.h"
#include "widgets/desk/commands.h"
#include "widgets/desk/recovery.h"
#include "widgets/desk/selection.h"
#include "widgets/desk/steps.h"
#include "widgets/worker/station_worker.h"

namespace seamwright {

class Desk : public QObject {
    Q_OBJECT
  public:
    explicit Desk(QObject* parent = nullptr);
    ~Desk() override;

    // --- the document
    bool is_open() const { return file_.has_value(); }
    const Project& project() const { return project_; }
    std::filesystem::path path() const;
    bool modified() const { return !undo_.isClean() || restored_; }
    QUndoStack& undo_stack() { return undo_; }
    Selection& selection() { return selection_; }
    StationWorker& worker() { return worker_; }
    LiveFeed& live() { return live_; }

    // An existing file is replaced (the caller has asked).
    Expected<void> create(const std::filesystem::path& path, const Project& project);
    // Opens as saved; unsaved edits of the project that is left are dropped (the caller has asked). What a
    // crash left is in recovery() until restore() or forget_recovery(), and stays on the disk until then.
    // What cannot be read is set aside beside the file, and trouble() says so.
    Expected<void> open(const std::filesystem::path& path);
    const std::optional<Recovery>& recovery() const { return recovery_; }
    void restore();
    void forget_recovery();
    Expected<void> save();
    // What another program has edited in the file that a run rests on; empty: nothing.
    QString edited_elsewhere() const;
    Expected<void> save_as(const std::filesystem::path& path);  // with runs and events
    void close();                                               // unsaved edits are dropped

    // --- who works; a project without users asks nobody
    bool asks_who() const;
    std::vector<User> users() const;
    const std::optional<Person>& person() const { return person_; }
    Expected<void> sign_in(const std::string& name, const std::string& password);
    void sign_out(const Text& why = "signed out");
    // What is refused is said before work is lost; what counts is refused by the file. Without a project: nothing.
    Expected<void> may(Deed deed) const;

    // --- edits; an Error changes nothing, and so does an edit that is none
    // T: Spot, Region, SensorSetup, RobotSetup, Calibration (add only). `at` < 0: at the end.
    template <class T>
    Expected<void> add(T thing, int at = -1);
    template <class T>
    Expected<void> remove(const std::string& id);
    template <class T>
    Expected<void> rename(const std::string& from, const std::string& to);
    template <class T>
    Expected<void> move(const std::string& id, int to);
    // The thing of that id becomes `after`; `what` names the field for the undo list.
    template <class T>
    Expected<void> edit(const T& after, const QString& what = {});
    Expected<void> set_spot_enabled(const std::string& id, bool enabled);
    Expected<void> set_spot_field(const SpotId& id, const std::string& field, double value);
    Expected<void> set_sensor_field(const SensorId& id, const std::string& field, double value);
    Expected<void> set_region_field(const RegionId& id, const std::string& field, double value);
    Expected<void> use_calibration(const SensorId& sensor_id, const CalibrationId& calibration_id);
    // Adds calibrations, and with `use` has each sensor use its own: all or none, one step of undo.
    Expected<void> take_calibrations(std::vector<Calibration> made, bool use);
    Expected<void> edit_part(const PartSetup& after, const QString& text);
    // STL, PLY, OBJ; `unit` "mm", "m", or "" (refused when metres are suspected). The file is read beside the window;
    // `told` hears on this thread how it went, unless another import or project came meanwhile.
    void import_part(const std::filesystem::path& mesh, const std::string& unit,
                     std::function<void(const Expected<void>&)> told);
    Expected<void> rename_project(const std::string& name);
    Expected<void> set_requirement(const std::string& field, double value);
    // What the acceptance asks for.
    Expected<void> edit_acceptance(const AcceptanceRequirements& after);
    // Whatever `change` does to the project, one step of undo.
    Expected<void> edit_project(const std::function<void(Project&)>& change, const QString& text);
    // After an exchange of sensor or robot, see projects/reuse/reteach.h; one step of undo. Returns how far
    // spots moved.
    Expected<std::vector<MovedSpot>> reteach(const Exchange& exchange);
    // Where the simulated part truly stands, in the settings of all simulated devices; connect again.
    Expected<void> place_simulated_part(const Pose& displacement, double bend_mm, double twist_mm);
    // A free id: "S1", "S2", ...
    template <class T>
    std::string free_id(const std::string& prefix) const;

    // --- motions from the desk. A robot that is no simulation moves only after a person has said that somebody stands beside
    // it, which is asked again after every connection.
    bool can_move(const std::string& robot_id) const;  // connected, and its driver moves it
    bool attended(const std::string& robot_id) const;  // said, or a simulation
    void attend(const std::string& robot_id, bool somebody_stands_beside);
    // Straight there; where nobody stands beside it, attendance_wanted() instead. false: it does not move.
    bool go_to(const std::string& robot_id, const Pose& base_from_flange);
    // Where a robot that was moved by hand stands, before the next state tells it.
    void note_pose(const std::string& robot_id, const Pose& base_from_flange);

    // --- what else is known
    const StationState& station() const { return *state_; }
    const std::vector<CheckItem>& checks() const { return checks_; }
    const StepStates& steps() const { return steps_; }
    const Facts& facts() const { return facts_; }
    Language language() const { return language_; }
    // Keeps what was proven with the project as it stands on the screen.
    Expected<void> record(const Evidence& evidence);
    Expected<std::vector<RunSummary>> runs() const;
    Expected<RunRecord> run(std::int64_t number) const;  // without captures
    Expected<std::vector<EventRecord>> events() const;
    Expected<void> delete_run(std::int64_t number);
    const ProjectFile& file() const { return *file_; }
    void set_language(Language language);  // of the checklist
    void note(EventKind kind, const std::string& subject, const Text& text);

  signals:
    void loading();         // another project is about to be opened(), not this one under another name
    void opened();          // another project, or none
    void person_changed();  // signed in, signed out
    // By edit, undo or redo; the sessions of its calibrations have followed. Before project_changed().
    void sensor_renamed(std::string from, std::string to);
    void robot_renamed(std::string from, std::string to);
    void project_changed();  // by edit, undo, redo, restore
    void modified_changed(bool modified);
    void checklist_changed();
    void station_changed();
    void attended_changed();
    void attendance_wanted(std::string robot_id);  // a motion was asked for
    void runs_changed();
    void events_changed();
    void recovery_written();  // every edit so far would survive a crash
    void trouble(QString sentence);

  private:
    Editor editor();
    void take_over(ProjectFile file, Project project);
    void drop_kept();    // the recovery file, unless it waits for an answer
    void keep_newest();  // the recovery file holds the project as it is
    void changed();
    void push(std::unique_ptr<DeskCommand> edit);
    template <class T>
    void device_renamed(const std::string& from, const std::string& to);
    // All edits that `edits` makes, or none: one change of the project and one step of undo.
    Expected<void> together(const QString& text, const std::function<Expected<void>()>& edits);
    void derive();
    void look_again();
    void select_measured_type();
    void set_recipes();
    void take_identities(const StationState& state);

    QUndoStack undo_;
    std::optional<std::vector<std::unique_ptr<DeskCommand>>> together_;  // made so far
    Selection selection_;
    LiveFeed live_;
    StationWorker worker_;
    Aside import_;
    RecoveryWriter recovery_writer_;
    std::optional<FileUse> use_;  // of file_
    std::optional<ProjectFile> file_;
    std::optional<SignedIn> signed_in_;
    std::optional<Person> person_;
    Project project_;
    std::optional<Recovery> recovery_;
    std::shared_ptr<const StationState> state_ = std::make_shared<const StationState>();
    Facts facts_;  // evidence: of this file
    std::vector<CheckItem> checks_;
    StepStates steps_;
    std::set<std::string> attended_;  // robots beside which somebody stands
    Language language_ = Language::english;
    bool restored_ = false, was_modified_ = false;
};

// Index in the list; -1 = unknown.
template <class T>
int index_of(const Project& project, const std::string& id) {
    const std::vector<T>& list = list_of<T>(project);
    for (std::size_t i = 0; i < list.size(); ++i)
        if (list[i].id == id) return static_cast<int>(i);
    return -1;
}

}  // namespace seamwright
