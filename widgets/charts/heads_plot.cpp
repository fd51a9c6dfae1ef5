#include "widgets/charts/heads_plot.h"

#include <QEvent>
#include <QVBoxLayout>
#include <cmath>
#include <limits>

#include "widgets/charts/legend_row.h"
#include "widgets/plot_canvas.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

constexpr double kAround_mm = 9;  // of the gap, to either side

}  // namespace

HeadsPlot::HeadsPlot(QWidget* parent) : QWidget(parent), canvas_(new PlotCanvas(this)) {
    auto* box = new QVBoxLayout(this);
    box->setContentsMargins(0, 0, 0, 0);
    box->addWidget(canvas_);
    setAccessibleName(tr("Profiles of the chosen place"));
    setToolTip(
        tr("Each head's profile in the place's frame; thin and dark: both as one, in which gap and flush are "
           "measured"));
    canvas_->setAccessibleName(accessibleName());
    canvas_->setToolTip(toolTip());
    canvas_->xAxis->setLabel(tr("along the surface, mm"));
    canvas_->yAxis->setLabel(tr("across, mm"));
    canvas_->equal_axes = true;
    put_legend_above(*canvas_);
    draw();
}

void HeadsPlot::set_profiles(const QStringList& names, const std::vector<Profile>& heads,
                             const Profile& merged, QPointF middle) {
    names_ = names;
    heads_ = heads;
    merged_ = merged;
    middle_ = middle;
    draw();
}

int HeadsPlot::curves() const {
    return canvas_->plottableCount();
}

void HeadsPlot::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::PaletteChange) draw();
}

void HeadsPlot::draw() {
    canvas_->clearPlottables();
    const auto add = [&](const Profile& profile, const QString& name, const QPen& pen) {
        if (profile.size() == 0) return;
        auto* curve =
            new QCPCurve(canvas_->xAxis, canvas_->yAxis);  // a head looks round a flank: x goes back
        curve->setName(name);
        curve->setPen(pen);
        std::int32_t segment = kOutlier;
        for (std::size_t i = 0; i < profile.size(); ++i) {
            const bool kept = !profile.filtered() || profile.segment[i] != kOutlier;
            if (!kept || !std::isfinite(profile.z_mm[i])) continue;
            // A segment ends where the line does.
            if (profile.filtered() && profile.segment[i] != segment && segment != kOutlier)
                curve->addData(profile.x_mm[i], std::numeric_limits<double>::quiet_NaN());
            if (profile.filtered()) segment = profile.segment[i];
            curve->addData(profile.x_mm[i], profile.z_mm[i]);
        }
    };
    // Broad below, thin above: neither hides the other.
    for (std::size_t k = 0; k < heads_.size(); ++k)
        add(heads_[k], names_.value(static_cast<int>(k)),
            QPen(style::segment(static_cast<int>(k), palette()), heads_.size() > 1 ? 6 : 2));
    if (heads_.size() > 1) add(merged_, tr("both as one"), QPen(style::text(palette()), 1.5));
    const bool any = canvas_->plottableCount() > 0;
    for (QCPAxis* axis : {canvas_->xAxis, canvas_->yAxis}) axis->setVisible(any);
    canvas_->legend->setVisible(any);
    if (any) show_legend(*canvas_, *this);
    if (any)
        canvas_->set_equal_view(
            {middle_.x() - kAround_mm, middle_.y() - kAround_mm / 2, 2 * kAround_mm, kAround_mm});
    canvas_->request_replot();
}

}  // namespace seamwright
