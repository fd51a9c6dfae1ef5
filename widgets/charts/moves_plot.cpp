#include "widgets/charts/moves_plot.h"

#include <QEvent>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "widgets/plot_canvas.h"
#include "widgets/style.h"

namespace seamwright {

MovesPlot::MovesPlot(QWidget* parent) : QWidget(parent), canvas_(new PlotCanvas(this)) {
    auto* box = new QVBoxLayout(this);
    box->setContentsMargins(0, 0, 0, 0);
    box->addWidget(canvas_);
    setAccessibleName(tr("What each move leaves"));
    setToolTip(
        tr("Gap and flush off the taught ones, rms over all places; 0: as the panel came; dashed: reached"));
    canvas_->setAccessibleName(accessibleName());
    canvas_->setToolTip(toolTip());
    canvas_->xAxis->setLabel(tr("move"));
    canvas_->yAxis->setLabel(tr("rms, mm"));
    draw();
}

void MovesPlot::set_moves(const std::vector<double>& rms_mm, double reached_mm) {
    rms_mm_ = rms_mm;
    reached_mm_ = reached_mm;
    draw();
}

void MovesPlot::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::PaletteChange) draw();
}

void MovesPlot::draw() {
    canvas_->clearPlottables();
    canvas_->clearItems();
    const bool any = !rms_mm_.empty();
    for (QCPAxis* axis : {canvas_->xAxis, canvas_->yAxis}) axis->setVisible(any);
    if (!any) return canvas_->request_replot();
    auto* graph = canvas_->addGraph();
    graph->setPen(QPen(style::segment(0, palette()), 2));
    graph->setScatterStyle(QCPScatterStyle(QCPScatterStyle::ssDisc, style::segment(0, palette()), 8));
    double most = reached_mm_;
    for (std::size_t i = 0; i < rms_mm_.size(); ++i) {
        graph->addData(static_cast<double>(i), rms_mm_[i]);
        if (std::isfinite(rms_mm_[i])) most = std::max(most, rms_mm_[i]);
    }
    auto* reached = new QCPItemStraightLine(canvas_);
    reached->point1->setCoords(0, reached_mm_);
    reached->point2->setCoords(1, reached_mm_);
    reached->setPen(QPen(style::good(palette()), 1.5, Qt::DashLine));
    QSharedPointer<QCPAxisTickerFixed> whole(new QCPAxisTickerFixed);  // half a move is none
    canvas_->xAxis->setTicker(whole);
    canvas_->xAxis->setRange(-0.2, std::max<double>(1, static_cast<double>(rms_mm_.size()) - 1) + 0.2);
    canvas_->yAxis->setRange(0, 1.1 * most + 1e-3);
    canvas_->request_replot();
}

}  // namespace seamwright
