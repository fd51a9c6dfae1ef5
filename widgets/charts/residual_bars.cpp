#include "widgets/charts/residual_bars.h"

#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "widgets/plot_canvas.h"
#include "widgets/style.h"

namespace seamwright {

struct ResidualBars::Impl {
    PlotCanvas* canvas = nullptr;
    std::vector<ResidualBar> data;
    QString selected;
    void rebuild();
};

void ResidualBars::Impl::rebuild() {
    const QPalette palette = canvas->parentWidget()->palette();
    canvas->clearPlottables();
    canvas->clearItems();
    QSharedPointer<QCPAxisTickerText> ticker(new QCPAxisTickerText);
    double reach = 0.05;
    const QString names[2] = {ResidualBars::tr("x"), ResidualBars::tr("z")};
    for (int axis = 0; axis < 2; ++axis) {
        auto* bars = new QCPBars(canvas->xAxis, canvas->yAxis);
        auto* out = new QCPBars(canvas->xAxis, canvas->yAxis);
        const QColor colour = style::segment(axis, palette);
        bars->setName(names[axis]);
        out->setName(ResidualBars::tr("left out"));
        out->removeFromLegend();
        for (QCPBars* one : {bars, out}) one->setWidth(0.3);
        bars->setPen(QPen(colour, 1));
        bars->setBrush(colour);
        out->setPen(QPen(style::alarm(palette), 1.5, Qt::DashLine));
        out->setBrush(QBrush(style::alarm(palette), Qt::BDiagPattern));
        for (std::size_t i = 0; i < data.size(); ++i) {
            const double v = data[i].residual_mm[axis == 0 ? 0 : 2];
            if (!std::isfinite(v)) continue;
            (data[i].used ? bars : out)->addData(static_cast<double>(i) + (axis == 0 ? -0.17 : 0.17), v);
            reach = std::max(reach, std::abs(v));
        }
    }
    for (std::size_t i = 0; i < data.size(); ++i) {
        const double x = static_cast<double>(i), s = 3 * data[i].sigma_mm;
        ticker->addTick(x, data[i].used ? data[i].spot : ResidualBars::tr("%1\nleft out").arg(data[i].spot));
        if (s > 0) {
            auto* band = new QCPItemRect(canvas);
            band->topLeft->setCoords(x - 0.4, s);
            band->bottomRight->setCoords(x + 0.4, -s);
            band->setPen(QPen(style::axis(palette), 1, Qt::DotLine));
            band->setBrush(Qt::NoBrush);
            reach = std::max(reach, s);
        }
        if (data[i].spot == selected) {
            auto* mark = new QCPItemRect(canvas);
            mark->topLeft->setType(QCPItemPosition::ptPlotCoords);
            mark->topLeft->setCoords(x - 0.46, 1e3);
            mark->bottomRight->setCoords(x + 0.46, -1e3);
            mark->setPen(QPen(style::selection(palette), 2));
        }
    }
    canvas->xAxis->setTicker(ticker);
    canvas->xAxis->setRange(-0.7, std::max(0.7, static_cast<double>(data.size()) - 0.3));
    canvas->yAxis->setRange(-1.15 * reach, 1.15 * reach);
    canvas->yAxis->setLabel(ResidualBars::tr("residual (mm), box 3 sigma"));
    canvas->legend->setVisible(!data.empty());
    canvas->request_replot();
}

ResidualBars::ResidualBars(QWidget* parent) : QWidget(parent), impl_(std::make_unique<Impl>()) {
    setAccessibleName(tr("Residuals per spot"));
    setToolTip(
        tr("What the correction leaves at each spot along the sensor's x and z. A click selects the spot."));
    impl_->canvas = new PlotCanvas(this);
    impl_->canvas->setAccessibleName(tr("Residual chart"));
    setFocusProxy(impl_->canvas);
    impl_->canvas->legend->setBorderPen(Qt::NoPen);
    impl_->canvas->legend->setBrush(Qt::NoBrush);
    impl_->canvas->legend->setFillOrder(QCPLegend::foColumnsFirst);
    impl_->canvas->axisRect()->insetLayout()->setInsetAlignment(0, Qt::AlignTop | Qt::AlignRight);
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    column->addWidget(impl_->canvas, 1);
    connect(impl_->canvas, &QCustomPlot::mouseRelease, this, [this](QMouseEvent* event) {
        const auto i = std::lround(impl_->canvas->xAxis->pixelToCoord(event->position().x()));
        if (i < 0 || i >= static_cast<long>(impl_->data.size())) return;
        select(impl_->data[static_cast<std::size_t>(i)].spot);
        emit spot_picked(impl_->selected);
    });
    QEvent event(QEvent::PaletteChange);
    changeEvent(&event);
}

ResidualBars::~ResidualBars() = default;

void ResidualBars::set_data(const std::vector<ResidualBar>& bars) {
    impl_->data = bars;
    impl_->rebuild();
}

void ResidualBars::select(const QString& spot) {
    if (impl_->selected == spot) return;
    impl_->selected = spot;
    impl_->rebuild();
}

void ResidualBars::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (!impl_ || !impl_->canvas) return;
    if (event->type() != QEvent::PaletteChange && event->type() != QEvent::FontChange) return;
    impl_->canvas->apply_style();
    impl_->canvas->xAxis->grid()->setVisible(false);
    impl_->canvas->legend->setFont(font());
    impl_->canvas->legend->setTextColor(style::quiet_text(palette()));
    impl_->rebuild();
}

}  // namespace seamwright
