#pragma once
// The rotation that cures a misalignment, drawn as an arrow about the sensor's axis.

#include <QWidget>

namespace seamwright {

class CureArrow : public QWidget {
  public:
    explicit CureArrow(QWidget* parent = nullptr);
    void set_cure(double about_z_deg, double about_x_deg, bool needed);
    QSize sizeHint() const override { return {220, 150}; }

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    void paint_axis(QPainter& painter, const QRectF& box, const QString& axis, double angle_deg);
    double about_z_deg_ = 0, about_x_deg_ = 0;
    bool needed_ = false;
};

}  // namespace seamwright
