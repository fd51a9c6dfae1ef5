#pragma once
// The camera's raw image with the peaks that were found in it.
//
// 8, 10, 12 and 16 bit are shown scaled from full scale to 8 bit; saturated pixels (full scale) are painted
// in the alarm colour and counted in words. The view owns a copy of the shown frame. Mouse: drag pans, wheel
// zooms, double click fits; with the region tool a drag marks a region of interest in pixels. Drawing at most
// 60 times a second.

#include <QRect>
#include <QWidget>
#include <array>
#include <memory>

#include "core/profile/stripe/stripe_image.h"

namespace seamwright {

// Grey values of an image in 64 equal classes from 0 to full scale, and the count at full scale. Every pixel
// is counted.
struct GreyHistogram {
    std::array<int, 64> classes{};
    int saturated = 0;
    int pixels = 0;
    int maximum = 0;  // largest grey value
};
GreyHistogram grey_histogram(const StripeImage& image);

class CameraView : public QWidget {
    Q_OBJECT
  public:
    explicit CameraView(QWidget* parent = nullptr);
    ~CameraView() override;

    // Pixels and peaks are copied; `peaks` may be null. An empty image clears the view.
    void set_frame(const StripeImage& image, const StripePeaks* peaks);
    void set_stale(bool stale);  // the shown image is old: it is drawn pale
    void set_peaks_shown(bool shown);
    void set_histogram_shown(bool shown);
    void set_region_tool(bool on);
    void set_region(const QRect& region_px);  // null: none
    QRect region() const;
    void set_caption(const QString& caption);
    void set_toolbar_shown(bool shown);
    void fit();
    const GreyHistogram& histogram() const;
    QPointF to_screen(const QPointF& pixel) const;  // pixel centres on whole numbers
    QPointF from_screen(const QPointF& position) const;

    QSize sizeHint() const override { return {640, 420}; }
    QSize minimumSizeHint() const override { return {240, 180}; }

  signals:
    void region_dragged(QRect region_px);
    void pixel_picked(QPoint pixel, int grey_8bit);  // as shown, 0..255; 255 = saturated

  protected:
    void changeEvent(QEvent* event) override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
