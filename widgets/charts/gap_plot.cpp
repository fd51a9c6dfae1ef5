#include "widgets/charts/gap_plot.h"

#include <QEvent>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <limits>

#include "widgets/charts/legend_row.h"
#include "widgets/plot_canvas.h"
#include "widgets/style.h"

namespace seamwright {

GapPlot::GapPlot(QWidget* parent) : QWidget(parent), canvas_(new PlotCanvas(this)) {
    auto* box = new QVBoxLayout(this);
    box->setContentsMargins(0, 0, 0, 0);
    box->addWidget(canvas_);
    setAccessibleName(tr("Width of the gap over the path"));
    setToolTip(tr("Width with 3 sigma below it; dashed: what the nozzle needs"));
    canvas_->xAxis->setLabel(tr("path, mm"));
    canvas_->yAxis->setLabel(tr("width, mm"));
    put_legend_above(*canvas_);
    draw();
}

void GapPlot::set_scan(const GapScan* scan, double need_mm) {
    points_ = scan ? scan->points : std::vector<GapPoint>();
    need_mm_ = need_mm;
    draw();
}

void GapPlot::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::PaletteChange) draw();
}

void GapPlot::draw() {
    constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
    canvas_->clearPlottables();
    canvas_->clearItems();
    for (QCPAxis* axis : {canvas_->xAxis, canvas_->yAxis}) axis->setVisible(!points_.empty());
    if (points_.empty()) return canvas_->request_replot();
    auto* width = canvas_->addGraph();
    width->setPen(QPen(style::segment(0, palette()), 2));
    width->setName(tr("width"));
    auto* least = canvas_->addGraph();
    least->setPen(QPen(style::segment(0, palette()), 1, Qt::DotLine));
    least->setName(tr("width - 3 sigma"));
    auto* bad = canvas_->addGraph();
    bad->setLineStyle(QCPGraph::lsNone);
    bad->setScatterStyle(QCPScatterStyle(QCPScatterStyle::ssCross, style::alarm(palette()), 8));
    bad->setName(tr("does not pass"));
    double most = need_mm_, lowest = 0;
    for (const GapPoint& p : points_) {
        const bool there = has_width(p.verdict);
        width->addData(p.path_mm, there ? p.width_mm : kNothing);
        least->addData(p.path_mm, there ? p.width_mm - 3 * p.sigma_mm : kNothing);
        if (p.verdict != GapVerdict::passes && p.verdict != GapVerdict::not_measured)
            bad->addData(p.path_mm, there ? p.width_mm : 0);
        if (there) most = std::max(most, p.width_mm), lowest = std::min(lowest, p.width_mm);
    }
    auto* need = new QCPItemStraightLine(canvas_);
    need->point1->setCoords(0, need_mm_);
    need->point2->setCoords(1, need_mm_);
    need->setPen(QPen(style::alarm(palette()), 1.5, Qt::DashLine));
    show_legend(*canvas_, *this);
    canvas_->xAxis->setRange(points_.front().path_mm,
                             std::max(points_.back().path_mm, points_.front().path_mm + 1));
    canvas_->yAxis->setRange(lowest, 1.1 * most + 0.1);
    canvas_->request_replot();
}

}  // namespace seamwright
