#pragma once
// What is asked before a project is used again: the mirror's plane, and what was exchanged.

#include <QCheckBox>
#include <QComboBox>
#include <QDialog>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QPushButton>

#include "projects/reuse/mirror.h"
#include "projects/reuse/reteach.h"
#include "widgets/editors/pose_editor.h"

namespace seamwright {

class MirrorDialog : public QDialog {
    Q_OBJECT
  public:
    explicit MirrorDialog(QWidget* parent = nullptr);
    MirrorPlane plane() const;

  private:
    QComboBox* axis_;
    QDoubleSpinBox* offset_;
};

// Shows how far each spot's flange pose will move before it is done.
class ExchangeDialog : public QDialog {
    Q_OBJECT
  public:
    explicit ExchangeDialog(const Project& project, QWidget* parent = nullptr);
    Exchange exchange() const;

  private:
    void fill_calibrations();
    void preview();
    const Project& project_;
    QComboBox *sensor_, *calibration_;
    QCheckBox* robot_;
    PoseEditor* workobject_;
    QLabel* outcome_;
    QPushButton* apply_;
};

}  // namespace seamwright
