#pragma once
// The plots of AlignView: offsets against travel, and the stack of profiles.

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "core/alignment/alignment.h"
#include "widgets/plot_canvas.h"
#include "widgets/profile/decimate.h"

namespace seamwright {

// dx, dz (mm) and dphi (degree) above each other over one travel axis, tolerance bands, jitter window.
class OffsetCanvas : public PlotCanvas {
  public:
    explicit OffsetCanvas(QWidget* parent);
    void set_data(const AlignmentResult& result, const AlignmentOptions& options);
    void clear();
    double jitter_mm = 5;
    std::function<void(double)> on_jitter;  // while it is dragged
    std::function<void(double)> on_travel;  // clicked
    void apply_style() override;

  protected:
    void paint_live(QPainter& painter, const QRect& area) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;

  private:
    void rebuild();
    QCPAxisRect* rect_of(int row) const { return rects_[static_cast<std::size_t>(row)]; }
    void drag_to(double half_width_mm);
    bool near_line(const QPointF& at) const;
    std::array<QCPAxisRect*, 3> rects_{};
    AlignmentResult result_;
    AlignmentOptions options_;
    bool filled_ = false, dragging_ = false;
};

// Profiles over travel: as an image (x, travel, height as brightness and hue) or laid over each other, with
// the live one thin over the thick frozen one.
class StackCanvas : public PlotCanvas {
  public:
    explicit StackCanvas(QWidget* parent);
    void set_pass(std::span<const TravelProfile> pass);
    void set_live(const Profile& profile);
    bool overlay = false;
    void rebuild();
    void apply_style() override;

  protected:
    void paint_live(QPainter& painter, const QRect& area) override;

  private:
    std::vector<TravelProfile> pass_;
    std::size_t frozen_ = 0;  // the profile nearest to the trigger
    Profile live_;
    QCPColorMap* map_ = nullptr;
    std::vector<ColumnStroke> strokes_;
    std::vector<int> outliers_;
};

}  // namespace seamwright
