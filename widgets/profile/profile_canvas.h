#pragma once
// The drawing surface of ProfilePlot; see there for what is shown.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "widgets/plot_canvas.h"
#include "widgets/profile/decimate.h"
#include "widgets/profile/profile_plot.h"

namespace seamwright {

class ProfileCanvas : public PlotCanvas {
  public:
    ProfileCanvas(ProfilePlot& plot, QWidget* parent);

    Profile profile, reference, placed_template;
    std::optional<Eigen::Vector2d> reference_point;
    std::optional<Feature> feature;
    std::optional<QRectF> window;
    bool intensity_shown = false, residuals_shown = false, untouched = true, stale = false;
    ProfilePlot::Tool tool = ProfilePlot::Tool::inspect;

    void profile_changed();  // takes the new trace into the next frame
    void marks_changed();    // everything over the axes
    void fit();
    QRectF bounds() const;  // of profile and reference; null when there is nothing
    void cancel_tool();
    QPointF pixel(const QPointF& mm) const;
    QPointF mm(const QPointF& pixel) const;
    void pan_by(double share_x, double share_y);
    void zoom_by(double factor, const QPointF& about_px);
    const std::vector<double>& residuals() const { return residuals_; }

  protected:
    void paint_live(QPainter& painter, const QRect& area) override;
    void view_changed() override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;

  private:
    struct Trace {
        std::vector<ColumnStroke> strokes;
        std::vector<int> outliers;
        bool dense = true;  // more than one point in three columns: strokes; else lines and dots
        QRect bounds;
    };
    TraceScale scale() const;
    void make_trace(const Profile& profile, Trace& trace) const;
    void paint_trace(QPainter& painter, const Profile& profile, const Trace& trace);
    void paint_thin(QPainter& painter, const Trace& trace, const QColor& colour, int thickness);
    void paint_intensity(QPainter& painter);
    void paint_marks(QPainter& painter);
    void paint_measure(QPainter& painter);
    void paint_residuals(QPainter& painter);
    QRect marks_bounds() const;

    ProfilePlot& plot_;
    Trace live_, below_, template_;
    QRect last_painted_, last_marks_;
    std::vector<double> residuals_;
    std::vector<QRect> rectangles_;
    std::vector<QLineF> lines_;
    std::optional<QPointF> press_px_, press_mm_;
    std::optional<QPointF> measure_from_, measure_to_;
    bool measuring_ = false, dragged_ = false, fitted_once_ = false;
    Qt::MouseButton press_button_ = Qt::NoButton;
    QCPRange press_x_, press_y_;
};

}  // namespace seamwright
