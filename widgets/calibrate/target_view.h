#pragma once
// The live picture with the target outlined, and the ring that fills while the robot stands still.

#include <QImage>
#include <QWidget>

#include "devices/frame.h"
#include "projects/calibrate/session/capture.h"

class QPainter;

namespace seamwright {

// Grey picture of at most `longest` pixels a side; null when the frame holds no image.
QImage small_picture(const StripeImage& image, int longest);

// Picture, points and outline fitted into `box`. Pixels grow downwards, millimetres upwards.
void paint_entry(QPainter& painter, const QRectF& box, const EntryPicture& entry, const QImage& background,
                 const QPalette& palette, bool used = true);

class TargetView : public QWidget {
    Q_OBJECT
  public:
    explicit TargetView(QWidget* parent = nullptr);
    // `words`: "target seen", or what is not seen.
    void set_live(const EntryPicture& entry, const QImage& background, bool seen, const QString& words);
    void set_ring(double filled, bool shown);  // 0..1
    bool seen() const { return seen_; }
    QSize sizeHint() const override { return {400, 220}; }
    QSize minimumSizeHint() const override { return {240, 180}; }

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    EntryPicture entry_;
    QImage background_;
    QString words_;
    bool seen_ = false, ring_shown_ = false;
    double ring_ = 0;
};

}  // namespace seamwright
