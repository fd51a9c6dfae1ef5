#pragma once
// A pose in the notation of the robot's brand. The notation's name stands beside the numbers; a whole pose is
// pasted into any field: 6 numbers (xyz and angles or rotation vector), 7 (xyz and quaternion, w first), 12
// or 16 (matrix, row by row), separated by blanks, commas, semicolons or line ends; letters and brackets
// around them are ignored.

#include <QWidget>
#include <memory>
#include <string>

#include "core/geometry/notation.h"

namespace seamwright {

enum class PoseNotation {
    kuka_abc,        // X Y Z mm, A B C degree (Z-Y'-X'')
    fanuc_wpr,       // X Y Z mm, W P R degree
    abb_quaternion,  // X Y Z mm, q1..q4 (w first)
    ur_rotvec,       // X Y Z mm, RX RY RZ rad
    matrix           // 4 x 4, mm
};
QString notation_name(PoseNotation notation);
// What a brand writes: "KUKA" -> kuka_abc, "ABB" -> abb_quaternion, "Universal Robots"/"UR" -> ur_rotvec,
// "FANUC" -> fanuc_wpr; anything else kuka_abc, the form of our files.
PoseNotation notation_of_brand(const std::string& brand);

// Error: wrong count of numbers, several poses, not finite, not a rotation.
Expected<Pose> pose_from_text(const QString& text, PoseNotation notation);
// What is pasted is no pose, but what one field holds, or should.
bool is_of_one_field(const QString& text);
QString text_from_pose(const Pose& pose, PoseNotation notation);

class PoseEditor : public QWidget {
    Q_OBJECT
  public:
    explicit PoseEditor(QWidget* parent = nullptr);
    ~PoseEditor() override;
    void set_notation(PoseNotation notation);  // the pose stays, the numbers change
    PoseNotation notation() const;
    Pose pose() const;
    void set_pose(const Pose& pose);  // no signal
    // The same, of the thing that is shown: what is being typed stays as long as that is the same one.
    void refresh(const Pose& pose, const std::string& of);
    bool refused() const;
    QString reason() const;

  signals:
    void committed();  // accepted and different from before; read pose()
    void notation_changed(seamwright::PoseNotation notation);

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
