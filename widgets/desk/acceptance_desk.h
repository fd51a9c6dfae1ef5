#pragma once
// The acceptance of the open project's selected region: judged on a thread of its own whenever runs, evidence or
// requirements have changed, by the functions that the command line and the reports use (projects/acceptance/). What it
// changes are undoable edits of the document.

#include <QObject>
#include <thread>

#include "projects/acceptance/agenda.h"
#include "widgets/desk/desk.h"

namespace seamwright {

class AcceptanceDesk : public QObject {
    Q_OBJECT
  public:
    explicit AcceptanceDesk(Desk& desk, QObject* parent = nullptr);
    ~AcceptanceDesk() override;

    // The selected region, else the first; empty: there is none.
    std::string region() const;
    // As last judged of region(); nullptr: not yet, or not possible (trouble()).
    const StoredAcceptance* stored() const {
        return judged_.stored && current() ? &*judged_.stored : nullptr;
    }
    const Agenda* agenda() const { return judged_.agenda && current() ? &*judged_.agenda : nullptr; }
    Text trouble() const { return current() ? judged_.trouble : Text(); }
    // Judges once more when something has changed since and nothing is measured; judged() says when it is done.
    void look();

    // Tables of another instrument, and artefacts with their certificate; kept while the project is open.
    Expected<void> import_references(const std::filesystem::path& csv);
    Expected<void> import_sensor_data(const std::filesystem::path& json);

    Expected<int> keep_offset();
    Expected<void> switch_offset(int version);  // 0: none acts

    // Ending .html: HTML, else PDF. Error (input): nothing is judged yet.
    Expected<report::Page> page(Language language) const;
    // As a workbook where the name ends in .xlsx, else as Q-DAS ASCII.
    Expected<void> write_values(const std::filesystem::path& path, Language language) const;

  signals:
    void judged();

  private:
    struct Judged {
        std::string region_id;
        std::optional<StoredAcceptance> stored;
        std::optional<Agenda> agenda;
        Text trouble;
    };
    bool current() const { return judged_.region_id == region(); }
    static Judged judge(const std::filesystem::path& file, const Project& project,
                        const std::string& region_id, const AcceptanceExtras& extras);
    Expected<void> edit_region(const std::function<Expected<void>(Region&)>& change, const QString& what);
    void keep(const MeasuredRobot& robot);
    void keep(const MeasuredTrigger& trigger);

    Desk& desk_;
    Judged judged_;
    AcceptanceExtras extras_;
    bool due_ = true, judging_ = false;
    int document_ = 0;  // counts projects opened: what was judged of another one is dropped
    std::jthread thread_;
};

}  // namespace seamwright
