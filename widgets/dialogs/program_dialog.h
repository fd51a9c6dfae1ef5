#pragma once
// The controller's side of the project (`robot-program`): the module that talks to Seamwright, the measuring program and
// the application's frames, for one robot and part type, into a folder. The project is taken as it stands on the screen.

#include <QComboBox>
#include <QDialog>
#include <QLabel>
#include <QTableWidget>
#include <optional>

#include "devices/robot_program.h"
#include "widgets/desk/desk.h"

namespace seamwright {

class ProgramDialog : public QDialog {
    Q_OBJECT
  public:
    explicit ProgramDialog(Desk& desk, QWidget* parent = nullptr);

    // Error: what program_request() and the brand refuse, and the file system.
    Expected<std::vector<std::filesystem::path>> write_into(const QString& folder);

  private:
    void fill();
    void choose_brand();
    void show_request();
    void choose_folder();
    QString said_of_same_files(const ProgramRequest& request, const std::vector<ProgramFile>& files) const;

    Desk& desk_;
    QComboBox *robot_, *type_, *brand_;
    QTableWidget* moves_;
    QLabel* verdict_;
    QPushButton* write_;
    QString same_files_;  // of what was written
    bool filling_ = false;
};

}  // namespace seamwright
