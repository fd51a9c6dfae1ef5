#pragma once
// Width of a gap over the path, with 3 sigma below it and what the nozzle needs.

#include <QWidget>

#include "core/features/gap/gap_scan.h"

namespace seamwright {

class PlotCanvas;

class GapPlot : public QWidget {
    Q_OBJECT
  public:
    explicit GapPlot(QWidget* parent = nullptr);
    void set_scan(const GapScan* scan, double need_mm);  // nullptr: none yet
    QSize sizeHint() const override { return {560, 220}; }
    QSize minimumSizeHint() const override { return {260, 140}; }

  protected:
    void changeEvent(QEvent* event) override;

  private:
    void draw();

    PlotCanvas* canvas_;
    std::vector<GapPoint> points_;
    double need_mm_ = 0;
};

}  // namespace seamwright
