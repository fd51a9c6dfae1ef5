#pragma once
// Every edit of the project, one undoable command class each. A command knows what it replaced, so that undo
// returns the project bit for bit. Made by Desk, which validates first and drops edits that change nothing.

#include <QCoreApplication>
#include <QUndoCommand>
#include <functional>
#include <memory>

#include "projects/model/project.h"
#include "widgets/menu_signs.h"

namespace seamwright {

// How a command reaches the document; set by Desk.
using Editor = std::function<void(const std::function<void(Project&)>&)>;

class DeskCommand : public QUndoCommand {
    Q_DECLARE_TR_FUNCTIONS(DeskCommand)
  public:
    explicit DeskCommand(Editor editor) : editor_(std::move(editor)) {}
    // Menus show it, which take the sign & of a name for a key.
    void setText(const QString& text) { QUndoCommand::setText(with_signs(text)); }
    void redo() final {
        editor_([this](Project& p) { apply(p); });
    }
    void undo() final {
        editor_([this](Project& p) { revert(p); });
    }
    virtual void apply(Project& project) = 0;
    virtual void revert(Project& project) = 0;

  private:
    Editor editor_;
};

// Edits that are right only together: the document changes once, so that nobody, not even a crash, meets
// half.
class CmdTogether final : public DeskCommand {
  public:
    CmdTogether(Editor editor, std::vector<std::unique_ptr<DeskCommand>> edits, const QString& text)
        : DeskCommand(std::move(editor)), edits_(std::move(edits)) {
        setText(text);
    }
    bool empty() const { return edits_.empty(); }
    void apply(Project& p) override {
        for (auto& edit : edits_) edit->apply(p);
    }
    void revert(Project& p) override {
        for (auto edit = edits_.rbegin(); edit != edits_.rend(); ++edit) (*edit)->revert(p);
    }

  private:
    std::vector<std::unique_ptr<DeskCommand>> edits_;
};

// The list of a thing in the project, and how people call it (translated, "spot").
template <class T>
std::vector<T>& list_of(Project& project);
template <class T>
const std::vector<T>& list_of(const Project& project) {
    return list_of<T>(const_cast<Project&>(project));
}
template <class T>
QString thing_name();

// Where other things may name a thing of that kind, always in the same order.
std::vector<std::string*> references(Project& project, const Spot*);
std::vector<std::string*> references(Project& project, const Region*);
std::vector<std::string*> references(Project& project, const SensorSetup*);
std::vector<std::string*> references(Project& project, const RobotSetup*);

template <class T>
class CmdAdd final : public DeskCommand {
  public:
    CmdAdd(Editor editor, T thing, std::size_t at)
        : DeskCommand(std::move(editor)), thing_(std::move(thing)), at_(at) {
        setText(DeskCommand::tr("Add %1 %2").arg(thing_name<T>(), QString::fromStdString(thing_.id)));
    }

  protected:
    void apply(Project& p) override {
        list_of<T>(p).insert(list_of<T>(p).begin() + static_cast<std::ptrdiff_t>(at_), thing_);
    }
    void revert(Project& p) override {
        list_of<T>(p).erase(list_of<T>(p).begin() + static_cast<std::ptrdiff_t>(at_));
    }

  private:
    T thing_;
    std::size_t at_;
};

// A spot leaves its regions with it.
template <class T>
class CmdRemove final : public DeskCommand {
  public:
    CmdRemove(Editor editor, const Project& project, std::size_t at)
        : DeskCommand(std::move(editor)),
          thing_(list_of<T>(project)[at]),
          regions_(project.regions),
          at_(at) {
        setText(DeskCommand::tr("Remove %1 %2").arg(thing_name<T>(), QString::fromStdString(thing_.id)));
    }

  protected:
    void apply(Project& p) override {
        list_of<T>(p).erase(list_of<T>(p).begin() + static_cast<std::ptrdiff_t>(at_));
        if constexpr (std::is_same_v<T, Spot>)
            for (Region& region : p.regions) std::erase(region.spot_ids, thing_.id);
    }
    void revert(Project& p) override {
        if constexpr (std::is_same_v<T, Spot>) p.regions = regions_;
        list_of<T>(p).insert(list_of<T>(p).begin() + static_cast<std::ptrdiff_t>(at_), thing_);
    }

  private:
    T thing_;
    std::vector<Region> regions_;
    std::size_t at_;
};

// With all that names it. What names a thing of the new id already (a calibration of a sensor that was
// removed) keeps that name when this is undone.
template <class T>
class CmdRename final : public DeskCommand {
  public:
    // Hears of every change of the name, undo and redo too, before the document tells it.
    using Told = std::function<void(const std::string& from, const std::string& to)>;
    CmdRename(Editor editor, std::size_t at, std::string from, std::string to, Told told = {})
        : DeskCommand(std::move(editor)),
          at_(at),
          from_(std::move(from)),
          to_(std::move(to)),
          told_(std::move(told)) {
        setText(DeskCommand::tr("Rename %1 %2 to %3")
                    .arg(thing_name<T>(), QString::fromStdString(from_), QString::fromStdString(to_)));
    }

  protected:
    void apply(Project& p) override {
        const auto all = references(p, static_cast<const T*>(nullptr));
        renamed_.clear();
        for (std::size_t i = 0; i < all.size(); ++i)
            if (*all[i] == from_) {
                *all[i] = to_;
                renamed_.push_back(i);
            }
        list_of<T>(p)[at_].id = to_;
        if (told_) told_(from_, to_);
    }
    void revert(Project& p) override {
        const auto all = references(p, static_cast<const T*>(nullptr));
        for (const std::size_t i : renamed_) *all[i] = from_;
        list_of<T>(p)[at_].id = from_;
        if (told_) told_(to_, from_);
    }

  private:
    std::size_t at_;
    std::string from_, to_;
    Told told_;
    std::vector<std::size_t> renamed_;  // of references()
};

template <class T>
class CmdMove final : public DeskCommand {
  public:
    CmdMove(Editor editor, const std::string& id, std::size_t from, std::size_t to)
        : DeskCommand(std::move(editor)), from_(from), to_(to) {
        setText(DeskCommand::tr("Move %1 %2").arg(thing_name<T>(), QString::fromStdString(id)));
    }

  protected:
    void apply(Project& p) override { move(list_of<T>(p), from_, to_); }
    void revert(Project& p) override { move(list_of<T>(p), to_, from_); }

  private:
    static void move(std::vector<T>& list, std::size_t from, std::size_t to) {
        T thing = std::move(list[from]);
        list.erase(list.begin() + static_cast<std::ptrdiff_t>(from));
        list.insert(list.begin() + static_cast<std::ptrdiff_t>(to), std::move(thing));
    }
    std::size_t from_, to_;
};

// `what` is the field in people's words ("weights"); empty = the thing as a whole.
template <class T>
class CmdEdit final : public DeskCommand {
  public:
    CmdEdit(Editor editor, T before, T after, std::size_t at, const QString& what)
        : DeskCommand(std::move(editor)), before_(std::move(before)), after_(std::move(after)), at_(at) {
        const QString id = QString::fromStdString(before_.id);
        setText(what.isEmpty() ? DeskCommand::tr("Change %1 %2").arg(thing_name<T>(), id)
                               : DeskCommand::tr("Change %3 of %1 %2").arg(thing_name<T>(), id, what));
    }

  protected:
    void apply(Project& p) override { list_of<T>(p)[at_] = after_; }
    void revert(Project& p) override { list_of<T>(p)[at_] = before_; }

  private:
    T before_, after_;
    std::size_t at_;
};

using CmdSpotAdd = CmdAdd<Spot>;
using CmdSpotRemove = CmdRemove<Spot>;
using CmdSpotRename = CmdRename<Spot>;
using CmdSpotMove = CmdMove<Spot>;
using CmdSpotEdit = CmdEdit<Spot>;
using CmdRegionAdd = CmdAdd<Region>;
using CmdRegionRemove = CmdRemove<Region>;
using CmdRegionRename = CmdRename<Region>;
using CmdRegionMove = CmdMove<Region>;
using CmdRegionEdit = CmdEdit<Region>;
using CmdSensorAdd = CmdAdd<SensorSetup>;
using CmdSensorRemove = CmdRemove<SensorSetup>;
using CmdSensorRename = CmdRename<SensorSetup>;
using CmdSensorEdit = CmdEdit<SensorSetup>;
using CmdRobotAdd = CmdAdd<RobotSetup>;
using CmdRobotRemove = CmdRemove<RobotSetup>;
using CmdRobotRename = CmdRename<RobotSetup>;
using CmdRobotEdit = CmdEdit<RobotSetup>;
using CmdCalibrationAdd = CmdAdd<Calibration>;

class CmdSpotEnable final : public DeskCommand {
  public:
    CmdSpotEnable(Editor editor, const std::string& id, std::size_t at, bool enabled);

  protected:
    void apply(Project& p) override { p.spots[at_].enabled = enabled_; }
    void revert(Project& p) override { p.spots[at_].enabled = !enabled_; }

  private:
    std::size_t at_;
    bool enabled_;
};

class CmdCalibrationUse final : public DeskCommand {
  public:
    CmdCalibrationUse(Editor editor, const SensorSetup& sensor, std::size_t at, std::string calibration_id);

  protected:
    void apply(Project& p) override { p.sensors[at_].calibration_id = after_; }
    void revert(Project& p) override { p.sensors[at_].calibration_id = before_; }

  private:
    std::size_t at_;
    std::string before_, after_;
};

class CmdPartEdit final : public DeskCommand {
  public:
    CmdPartEdit(Editor editor, PartSetup before, PartSetup after, const QString& text);

  protected:
    void apply(Project& p) override { p.part = after_; }
    void revert(Project& p) override { p.part = before_; }

  private:
    PartSetup before_, after_;
};

class CmdRequirementsEdit final : public DeskCommand {
  public:
    CmdRequirementsEdit(Editor editor, const Requirements& before, const Requirements& after);

  protected:
    void apply(Project& p) override { p.requirements = after_; }
    void revert(Project& p) override { p.requirements = before_; }

  private:
    Requirements before_, after_;
};

// Many things at once, with one reason: the project as a whole.
class CmdProjectReplace final : public DeskCommand {
  public:
    CmdProjectReplace(Editor editor, Project before, Project after, const QString& text)
        : DeskCommand(std::move(editor)), before_(std::move(before)), after_(std::move(after)) {
        setText(text);
    }

  protected:
    void apply(Project& p) override { p = after_; }
    void revert(Project& p) override { p = before_; }

  private:
    Project before_, after_;
};

class CmdProjectRename final : public DeskCommand {
  public:
    CmdProjectRename(Editor editor, std::string before, std::string after);

  protected:
    void apply(Project& p) override { p.name = after_; }
    void revert(Project& p) override { p.name = before_; }

  private:
    std::string before_, after_;
};

}  // namespace seamwright
