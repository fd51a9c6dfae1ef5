#pragma once
// The part in 3D (VTK inside Qt): mesh, spots with laser plane and sensor, regions, corrections, path, robot.
//
// Frame: work object, millimetres. All poses are workobject_from_... Managers (scene_managers.h) alone touch
// actors; the view hands them values. Render requests are coalesced: at most 60 pictures a second, none when
// nothing changed. Mouse: left drag turns, middle or Shift+left moves, wheel zooms, a click picks, right drag encircles. Keys: 1
// front, 2 top, 3 iso, F fit, Escape selects nothing. Without OpenGL 3.2 (remote desktop, broken driver) a
// sentence takes the picture's place and everything else works.

#include <Eigen/Core>
#include <QImage>
#include <QString>
#include <QWidget>
#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/geometry/pose.h"

namespace seamwright {

struct SceneSpot {
    std::string id;
    Pose workobject_from_sensor = Pose::Identity();
    Eigen::Vector3d reference_mm = Eigen::Vector3d::Zero();  // sensor frame
    bool enabled = true;
    double field_mm = 100;      // width of the laser line at the reference
    double stand_off_mm = 300;  // laser to reference along the sensor's +Z
    // How far the contour was found from its reference; drawn times the correction scale. Work object frame.
    std::optional<Eigen::Vector3d> shift_mm;
};

struct SceneRegion {
    std::string id;
    std::vector<std::string> spot_ids;
    // Translation (work object, unit length) that the region sees worst; zero = none drawn.
    Eigen::Vector3d weak_direction = Eigen::Vector3d::Zero();
    std::string weak_text;  // "weakest: along X, 0.4 mm"
};

// Coloured by how far each point moves, from the least (sky blue) to the most (vermilion) of this path; the numbers stand at
// its worst point. Around it a tube of 3 sigma, as exaggerated as the shift.
struct ScenePath {
    std::vector<Eigen::Vector3d> before_mm, after_mm;  // as taught; as corrected
    bool closed = false;
    std::vector<double> sigma_mm = {};  // of the corrected points; empty: no tube
    bool operator==(const ScenePath&) const = default;
};

// An edge of the drawing, that can be picked.
struct SceneEdge {
    std::string id;
    std::vector<Eigen::Vector3d> points_mm;
    QString words = {};  // beside its name while the pointer is on it
};

struct SceneRobot {
    Pose workobject_from_flange = Pose::Identity(), workobject_from_sensor = Pose::Identity();
};

// Vertices in mm, 3 indices a triangle.
struct SceneMesh {
    std::vector<std::array<float, 3>> points;
    std::vector<std::array<int, 3>> triangles;
};

class SceneView : public QWidget {
    Q_OBJECT
  public:
    enum class Layer { part, spots, sensors, regions, corrections, path, edges, robot, labels };
    enum class View { front, back, top, iso, fit };

    explicit SceneView(QWidget* parent = nullptr);
    ~SceneView() override;

    // Binary or ASCII PLY, millimetres, as in PartSetup::mesh_ply; empty bytes remove the part. Read beside the window:
    // part_read() says when it is shown, or that it is no PLY and nothing is.
    void set_part_ply(const std::vector<std::byte>& ply);
    void set_part(const SceneMesh& mesh);  // at once
    // What is set next is another project's: as soon as its part is there, or its spots where it has none, the picture is
    // fitted to it, once. So it is with the first one.
    void expect_another();
    bool has_part() const;                                  // it is shown
    void set_part_shift(const Pose& workobject_from_part);  // displaced part; identity at teaching
    void set_spots(const std::vector<SceneSpot>& spots);
    void set_regions(const std::vector<SceneRegion>& regions);
    void set_path(const ScenePath& path);
    // While there are edges, the one under the pointer lights up, and a click there takes it before spots and part.
    void set_edges(std::vector<SceneEdge> edges);
    // From outside; no signal is sent for it. The first one is named in the picture, the others are its chain.
    void choose_edges(const std::vector<std::string>& ids);
    // Spots that are not the project's yet, as ghosts; they can be taken hold of with the left button.
    void set_proposed(const std::vector<SceneSpot>& spots);
    void set_robot(const std::optional<SceneRobot>& robot);
    // Where the robot is to go next, half transparent beside where it stands; belongs to the robot's layer.
    // When one appears, the picture is fitted to both; when it goes, to the part again.
    void set_next_robot(const std::optional<SceneRobot>& next);
    // Places of the part that were picked so far, numbered from 1.
    void set_picks(const std::vector<Eigen::Vector3d>& picks_mm);
    void set_correction_scale(double factor);  // drawn length / true length, 1..1000; default 20

    // From outside; "" selects nothing. No signal is sent for it.
    void select_spot(const std::string& id);
    void select_region(const std::string& id);
    std::string selected_spot() const;

    // The next drag draws a line around spots instead of turning the part; the right button does so always.
    void begin_lasso();
    void show_view(View view);
    void set_layer(Layer layer, bool shown);
    bool layer(Layer layer) const;
    void set_toolbar_shown(bool shown);
    bool has_opengl() const;  // known after the first show
    QImage picture();         // what the view shows; null without OpenGL
    Expected<void> save_picture(const std::filesystem::path& png);
    QPointF to_screen(const Eigen::Vector3d& point_workobject_mm) const;  // in this widget
    int pictures_rendered() const;  // for measuring how well requests are coalesced

    QSize sizeHint() const override { return {820, 420}; }
    QSize minimumSizeHint() const override { return {280, 220}; }

  signals:
    void part_read(bool readable);
    void spot_picked(QString id);                    // "" = nothing there
    void part_picked(double x, double y, double z);  // work object, mm
    void edge_picked(QString id);
    void proposed_dragged(QString id, QPointF at);  // of set_proposed(); the pointer in this widget
    void spots_encircled(QStringList ids);          // in the order of measuring; may be none

  protected:
    void changeEvent(QEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
