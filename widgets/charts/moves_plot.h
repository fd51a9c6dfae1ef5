#pragma once
// What a motion in several moves leaves: gap and flush against taught, rms over all places, move by move, and what counts
// as reached.

#include <QWidget>
#include <vector>

namespace seamwright {

class PlotCanvas;

class MovesPlot : public QWidget {
    Q_OBJECT
  public:
    explicit MovesPlot(QWidget* parent = nullptr);
    // The first one: as it came, before any move. Empty: none yet.
    void set_moves(const std::vector<double>& rms_mm, double reached_mm);
    const std::vector<double>& moves() const { return rms_mm_; }
    QSize sizeHint() const override { return {320, 220}; }
    QSize minimumSizeHint() const override { return {220, 150}; }

  protected:
    void changeEvent(QEvent* event) override;

  private:
    void draw();

    PlotCanvas* canvas_;
    std::vector<double> rms_mm_;
    double reached_mm_ = 0;
};

}  // namespace seamwright
