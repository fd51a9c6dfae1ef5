#pragma once
// Spots from the drawing (projects/placing): a drawing is read, the edge that the bead follows is picked in the scene or
// from the list, spots along it are proposed with their forecast, moved along it if so wished (by dragging their ghosts
// or by steps; the forecast follows), and taken into the project as one edit: from the drawing, not confirmed. Nothing
// moves a robot. Reading and proposing run beside the window and can be cancelled; a project that is left closes it.

#include <QCheckBox>
#include <QComboBox>
#include <QDialog>
#include <QLabel>
#include <QLineEdit>
#include <QProgressBar>
#include <QSpinBox>
#include <QTableWidget>
#include <memory>
#include <thread>

#include "projects/placing/take.h"
#include "widgets/desk/desk.h"
#include "widgets/editors/number_box.h"
#include "widgets/scene/scene_view.h"

namespace seamwright {

class PlaceDialog : public QDialog {
    Q_OBJECT
  public:
    PlaceDialog(Desk& desk, SceneView& scene, QWidget* parent = nullptr);
    ~PlaceDialog() override;

    void take_file(const QString& file);  // begins to read it
    void choose_edge(const QString& id);
    void propose();
    // To the place that is nearest to the pointer (SceneView::proposed_dragged).
    void drag(const QString& spot_id, const QPointF& at);
    void step(int way);  // the chosen spot to the next free place, on (1) or back (-1)
    void take();         // what was proposed
    bool working() const { return working_; }

  private:
    struct ReadDrawing {
        std::string file;  // its bytes
        Drawing drawing;
    };
    template <class Made>
    void begin(
        std::function<Made(const std::stop_token&, const std::function<void(double, const Text&)>&)> make,
        std::function<void(Made)> done);
    void choose_file();
    void show_drawing(Expected<ReadDrawing> read);
    void show_edge();
    void show_proposal(Expected<Proposal> proposal);
    bool move_to(const std::string& spot_id, std::size_t place);  // false: another one stands there
    void forget_proposal();
    void state();

    Desk& desk_;
    SceneView& scene_;
    QLineEdit* file_;
    QComboBox *edge_, *region_;
    NumberBox *wanted_, *cone_, *beyond_, *noise_;
    QSpinBox *fewest_, *most_;
    QCheckBox* lost_;
    QPushButton *choose_, *propose_, *cancel_, *back_, *on_, *take_;
    QProgressBar* progress_;
    QLabel* verdict_;
    QTableWidget* spots_;
    std::shared_ptr<const ReadDrawing> read_;
    std::optional<Proposal> proposal_;
    bool working_ = false, filling_ = false;
    std::jthread thread_;  // last: it ends before what it reads
};

}  // namespace seamwright
