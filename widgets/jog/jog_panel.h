#pragma once
// The robot moved by hand, beside the live picture: along and about the axes of base, flange or sensor, in steps or as long
// as a key is pressed. It stops when the key is let go, when the panel loses the focus or is hidden, and with Esc. A
// robot that is no simulation moves only after a person has said that somebody stands beside it, which is asked
// again after every connection.

#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QPushButton>
#include <QTimer>
#include <QWidget>
#include <array>
#include <chrono>
#include <optional>
#include <string>

#include "core/geometry/jog.h"
#include "widgets/desk/desk.h"

namespace seamwright {

class JogPanel : public QWidget {
    Q_OBJECT
  public:
    explicit JogPanel(Desk& desk, QWidget* parent = nullptr);

  protected:
    void hideEvent(QHideEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;  // choices side by side where there is room
    void keyPressEvent(QKeyEvent* event) override;
    bool event(QEvent* event) override;
    bool eventFilter(QObject* watched, QEvent* event) override;  // of the keys

  private:
    // A key: along (0..2) or about (3..5) an axis, one way.
    struct Key {
        QPushButton* button = nullptr;
        int axis = 0;
        double sign = 1;
    };
    void make_choices();
    void make_keys();
    void refresh();
    void ask_for(const std::string& robot_id);  // that somebody stands beside it
    void pressed(const Key& key);
    void stop();
    void advance();  // while a key is pressed
    void step(double mm, double deg);
    void moved(const std::string& robot_id, const Pose& base_from_flange, const QString& trouble);
    const RobotState* state() const;
    bool allowed() const;
    std::string robot() const;
    Pose flange_from_sensor() const;

    Desk& desk_;
    QComboBox *robot_, *frame_, *way_, *step_;
    QDoubleSpinBox* speed_;
    QCheckBox* consent_;
    QLabel *asked_, *place_, *message_;
    QBoxLayout* columns_ = nullptr;
    std::array<Key, 12> keys_;
    const Key* pressed_ = nullptr;
    QTimer timer_;
    std::chrono::steady_clock::time_point advanced_, sent_;
    // Where the robot was sent last; its next step starts there until it has arrived.
    std::optional<Pose> target_;
};

}  // namespace seamwright
