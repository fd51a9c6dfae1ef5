#pragma once
// The live profile in the sensor frame: x to the right, z up, millimetres, both axes at one scale.
//
// Points are coloured by segment; outliers are crosses; the found feature carries its 2 sigma ellipse; the
// reference profile and the template lie under the points. A dense profile is drawn as one vertical stroke
// per pixel column from its lowest to its highest point (decimate.h), which looks as all points would and
// costs what the columns cost. Setters only store; drawing happens at most 60 times a second, and only where
// the trace was or is.
//
// Mouse: drag pans, wheel zooms about the cursor, double click fits (Tool::inspect). Keys: F fit, Space
// freeze, M measure, arrows pan, + and - zoom, Escape leaves a tool.

#include <Eigen/Core>
#include <QPointF>
#include <QRectF>
#include <QWidget>
#include <memory>
#include <optional>

#include "core/features/feature.h"
#include "core/profile/profile.h"

namespace seamwright {

class ProfilePlot : public QWidget {
    Q_OBJECT
  public:
    // What a click means. `inspect` pans; a click there picks the contour point beside it.
    enum class Tool { inspect, measure, window, reference };

    explicit ProfilePlot(QWidget* parent = nullptr);
    ~ProfilePlot() override;

    // The newest profile, as the sensor gave it or filtered. Copied into a kept buffer. While frozen the
    // screen stays; the newest one is shown when the freeze ends.
    void set_profile(const Profile& profile);
    void set_feature(const std::optional<Feature>& feature);
    // The shown profile is old: it is drawn grey and thin, without segments, until the next one is set.
    void set_stale(bool stale);
    bool stale() const;
    // Of teaching: its contour thin beneath the live one, and the reference point (sensor frame x, z).
    void set_reference(const Profile& profile, const std::optional<Eigen::Vector2d>& reference_mm);
    void clear_reference();
    // The template's contour where it was found (or taught), placed in the sensor frame by the caller.
    void set_template(const Profile& placed);
    void clear_template();
    // Search window or template window: x, z of its lower left corner, width, height, mm. Null: none.
    void set_window(const std::optional<QRectF>& window_mm);
    // "sensor A  1000 /s  0 dropped": at the head of the plot.
    void set_caption(const QString& caption);

    void set_tool(Tool tool);
    Tool tool() const;
    void set_frozen(bool frozen);
    bool frozen() const;
    void set_residuals_shown(bool shown);  // histogram of distances to the reference profile
    bool residuals_shown() const;
    void set_intensity_shown(bool shown);
    void set_toolbar_shown(bool shown);
    void fit();                                  // all points of profile and reference
    void set_view(const QRectF& mm);             // the smallest view at equal scale that holds this rectangle
    QRectF view() const;                         // x, z of the lower left corner, width, height, mm
    QPointF to_screen(const QPointF& mm) const;  // position in this widget
    QPointF from_screen(const QPointF& pixel) const;
    // Distances of the shown profile's accepted points across the reference contour, mm, signed +z.
    const std::vector<double>& residuals_mm() const;
    // Draws everything that is due, without waiting for the next frame: for pictures.
    void flush();

    QSize sizeHint() const override { return {820, 360}; }
    QSize minimumSizeHint() const override { return {280, 180}; }

  signals:
    void point_picked(QPointF point_mm,
                      int index);  // nearest accepted contour point, its index in the profile
    void window_dragged(QRectF window_mm);
    void reference_clicked(QPointF point_mm);  // exactly where clicked
    // From the first to the second click; the angle is that of the line against +x towards +z, -180..180.
    void measured(double distance_mm, double angle_deg);
    void frozen_changed(bool frozen);
    void tool_changed(seamwright::ProfilePlot::Tool tool);

  protected:
    void changeEvent(QEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
