#pragma once
// The views beside the pages, and what fills them whatever page is shown: the live feed into plot and camera,
// the project into the scene.

#include <QElapsedTimer>
#include <QObject>
#include <QTimer>
#include <functional>
#include <map>
#include <string>

#include "projects/model/run.h"
#include "widgets/align/align_view.h"
#include "widgets/charts/histogram.h"
#include "widgets/charts/residual_bars.h"
#include "widgets/charts/trend_chart.h"
#include "widgets/desk/desk.h"
#include "widgets/profile/camera_view.h"
#include "widgets/profile/profile_plot.h"
#include "widgets/scene/scene_view.h"

namespace seamwright {

// Owned by the window; all exist as long as the pages do.
struct Views {
    ProfilePlot* profile = nullptr;
    CameraView* camera = nullptr;
    SceneView* scene = nullptr;
    AlignView* align = nullptr;
    TrendChart* trend = nullptr;
    Histogram* histogram = nullptr;
    ResidualBars* residuals = nullptr;
    QWidget* jog = nullptr;
    std::function<void(QWidget*)> raise;  // brings the view's dock to the front
};

// The sensor that is looked through: of the selected spot, else the selected, else the first.
std::string shown_sensor(const Desk& desk, const Selection& selection);
Pose workobject_from_sensor(const Project& project, const Spot& spot);

class ViewFeeder : public QObject {
    Q_OBJECT
  public:
    ViewFeeder(Desk& desk, Views views, QObject* parent);
    // Corrections of a run as arrows at the spots; nullptr removes them.
    void show_run(const RunRecord* run);
    void show_latest();  // a view that was hidden is shown: it gets the newest picture

  private:
    void live();
    void age();
    void caption(const QString& text, bool stale);
    void crop(const QRect& region_px);
    void selected();
    void project();
    void robot();
    Desk& desk_;
    Views views_;
    std::map<std::string, Eigen::Vector3d> shifts_;
    std::vector<std::byte> shown_mesh_;
    QTimer age_timer_;
    std::uint64_t last_number_ = 0;
    std::string last_sensor_;
    QString caption_;
    QElapsedTimer caption_age_;
    std::string captioned_sensor_;
    Text captioned_trouble_;
    std::uint64_t captioned_dropped_ = 0;
};

}  // namespace seamwright
