#pragma once
// The application's path as a run corrects it (projects/path), before it is written: what of it may be run, region by
// region, and in the scene as taught and as corrected. Nothing is sent to a robot. Stays open beside the desk; a project
// that is left closes it, a new run joins its list.

#include <QCheckBox>
#include <QComboBox>
#include <QDialog>
#include <QLabel>
#include <QLineEdit>
#include <QTableWidget>
#include <optional>

#include "projects/path/corrected_path.h"
#include "widgets/desk/desk.h"
#include "widgets/editors/number_box.h"
#include "widgets/scene/scene_view.h"

namespace seamwright {

class PathDialog : public QDialog {
    Q_OBJECT
  public:
    PathDialog(Desk& desk, SceneView& scene, QWidget* parent = nullptr);
    ~PathDialog() override;

    void take_file(const QString& file);  // table or program; the answer is shown at once
    // Into a folder. Error: nothing that may be run, what the file system refuses.
    Expected<std::vector<std::filesystem::path>> write_into(const QString& folder);

  private:
    void fill_runs();
    void correct();
    void show_answer();
    void choose_file();
    void choose_folder();
    PathOrigin origin() const;

    Desk& desk_;
    SceneView& scene_;
    QLineEdit* file_;
    QComboBox *notation_, *frame_, *run_, *brand_;
    QCheckBox *closed_, *leave_out_;
    QLabel *verdict_, *remarks_;
    QTableWidget* regions_;
    NumberBox* speed_;
    QLineEdit* name_;
    QPushButton* write_;
    std::optional<CorrectedByRun> corrected_;
    bool filling_ = true;  // until the first answer can be shown
};

}  // namespace seamwright
