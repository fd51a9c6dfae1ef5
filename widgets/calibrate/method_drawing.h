#pragma once
// One line drawing a method: what stands where.

#include <QWidget>

#include "projects/calibrate/methods/method.h"

namespace seamwright {

class MethodDrawing : public QWidget {
    Q_OBJECT
  public:
    explicit MethodDrawing(QWidget* parent = nullptr);
    void set_drawing(SetUpDrawing what);
    QSize sizeHint() const override { return {150, 150}; }
    QSize minimumSizeHint() const override { return {120, 120}; }

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    SetUpDrawing what_ = SetUpDrawing::board;
};

}  // namespace seamwright
