#pragma once
// A session into a capture (`record`): everything that sensors and robots deliver from here on, whatever is done with them
// meanwhile: live profiles, teaching, runs. The devices connect anew when it begins and when it ends. Closing the window
// or leaving the project ends it; what was committed stays.

#include <QCheckBox>
#include <QDialog>
#include <QLabel>
#include <QTableWidget>
#include <QTimer>
#include <memory>

#include "devices/capture/recorder.h"
#include "widgets/desk/desk.h"

namespace seamwright {

class RecordDialog : public QDialog {
    Q_OBJECT
  public:
    explicit RecordDialog(Desk& desk, QWidget* parent = nullptr);
    ~RecordDialog() override;

    // Into a file that is not there yet. Error: a recording runs, the file.
    Expected<void> start(const QString& file);
    void stop();

  private:
    void ask_and_start();
    void show_status();
    void show_counters(const RecorderStatus& status);

    Desk& desk_;
    QCheckBox* images_;
    QLabel* verdict_;
    QTableWidget* sources_;
    QPushButton *start_, *stop_;
    QTimer timer_;
    QString file_;
    std::shared_ptr<Recorder> recorder_;
};

}  // namespace seamwright
