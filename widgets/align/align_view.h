#pragma once
// The frozen contour: does the contour stand still while the robot passes the spot?
//
// Left: dx, dz and dphi of every profile against travel, with the tolerance band and two lines that bound the
// jitter window (drag either; they stay symmetric about the trigger at 0). Below them the profiles over
// travel, as an image (x, travel, height) or laid over each other. Right: the verdict as a word, then the
// numbers and the rotation that cures it, as an arrow about the sensor's axis.

#include <QWidget>
#include <memory>
#include <span>

#include "core/alignment/alignment.h"

namespace seamwright {

class AlignView : public QWidget {
    Q_OBJECT
  public:
    enum class Stack { image, overlay };

    explicit AlignView(QWidget* parent = nullptr);
    ~AlignView() override;

    // The judged pass. `pass` and `result.offsets` are in the same order; options carry tolerance and jitter. `widened`:
    // a tolerance beyond what is required, at which standing still is no good news.
    void set_result(std::span<const TravelProfile> pass, const AlignmentResult& result,
                    const AlignmentOptions& options, bool widened = false);
    // While the pass is being recorded: profiles so far, not judged yet.
    void set_recording(std::span<const TravelProfile> pass);
    // The profile the sensor sees now, drawn thin over the frozen one (thick). An empty profile removes it.
    void set_live(const Profile& profile);
    void clear();
    void set_stack(Stack stack);
    Stack stack() const;
    double jitter_mm() const;
    QString verdict() const;  // the word on the screen: "FROZEN", "DRIFTING", ...

    QSize sizeHint() const override { return {1000, 620}; }
    QSize minimumSizeHint() const override { return {460, 220}; }

  signals:
    // The jitter window was dragged: half width, mm. The owner judges again (check_alignment is fast) and
    // calls set_result.
    void jitter_dragged(double half_width_mm);
    void travel_picked(double travel_mm);

  protected:
    void changeEvent(QEvent* event) override;
    // The profiles of the pass are drawn where there is room for both plots.
    void resizeEvent(QResizeEvent* event) override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
