#include "widgets/charts/histogram.h"

#include <QLabel>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "widgets/plot_canvas.h"
#include "widgets/style.h"

namespace seamwright {

struct Histogram::Impl {
    bool of_process = true;
    PlotCanvas* canvas = nullptr;
    QLabel* title = nullptr;
    QString name, unit;
    std::vector<double> values;
    TrendLimits limits;
    Capability shown;

    void rebuild();
};

void Histogram::Impl::rebuild() {
    const QPalette palette = canvas->parentWidget()->palette();
    canvas->clearPlottables();
    canvas->clearItems();
    std::vector<double> sorted;
    for (const double v : values)
        if (std::isfinite(v)) sorted.push_back(v);
    std::sort(sorted.begin(), sorted.end());
    shown = capability(values, limits);
    const auto number = [](double v) { return QString::number(v, 'f', 3); };
    QString text = name;
    if (sorted.size() < 2) {
        title->setText(text + "\n" + Histogram::tr("fewer than two values"));
        canvas->request_replot();
        return;
    }
    text += "   " + Histogram::tr("n %1   mean %2   s %3 %4")
                        .arg(shown.count)
                        .arg(number(shown.mean), number(shown.standard_deviation), unit);
    if (of_process && shown.cp) text += "   " + Histogram::tr("Cp %1").arg(*shown.cp, 0, 'f', 2);
    if (of_process && shown.cpk) text += "   " + Histogram::tr("Cpk %1").arg(*shown.cpk, 0, 'f', 2);
    if (of_process && shown.cpk && shown.count < 50) text += " " + Histogram::tr("(few values)");
    title->setText(text);

    const std::size_t n = sorted.size();
    const double spread = sorted[n * 3 / 4] - sorted[n / 4], whole = sorted.back() - sorted.front();
    double width = 2 * spread / std::cbrt(static_cast<double>(n));
    if (!(width > 0)) width = whole > 0 ? whole / 5 : 1;
    const int classes = std::clamp(static_cast<int>(std::ceil(whole / width)), 5, 60);
    width = whole > 0 ? whole / classes : 1;
    QVector<double> keys(classes), counts(classes, 0.0);
    for (int i = 0; i < classes; ++i) keys[i] = sorted.front() + (i + 0.5) * width;
    for (const double v : sorted)
        counts[std::clamp(static_cast<int>((v - sorted.front()) / width), 0, classes - 1)] += 1;
    auto* bars = new QCPBars(canvas->xAxis, canvas->yAxis);
    bars->setWidthType(QCPBars::wtPlotCoords);
    bars->setWidth(width * 0.94);
    bars->setPen(Qt::NoPen);
    bars->setBrush(style::segment(0, palette));
    bars->setData(keys, counts, true);
    const double highest = *std::max_element(counts.begin(), counts.end());

    // The normal curve that Cp and Cpk assume, for the eye to judge.
    double low = sorted.front() - width, high = sorted.back() + width;
    if (limits.lower) low = std::min(low, *limits.lower - width);
    if (limits.upper) high = std::max(high, *limits.upper + width);
    if (shown.standard_deviation > 0) {
        auto* curve = canvas->addGraph();
        curve->setPen(QPen(style::quiet_text(palette), 1.5));
        constexpr double kSqrt2Pi = 2.5066282746310002;
        for (int i = 0; i <= 160; ++i) {
            const double x = low + (high - low) * i / 160;
            const double u = (x - shown.mean) / shown.standard_deviation;
            curve->addData(x, static_cast<double>(n) * width / (shown.standard_deviation * kSqrt2Pi) *
                                  std::exp(-0.5 * u * u));
        }
    }
    for (const auto& limit : {limits.lower, limits.upper}) {
        if (!limit) continue;
        auto* line = new QCPItemStraightLine(canvas);
        line->point1->setCoords(*limit, 0);
        line->point2->setCoords(*limit, 1);
        line->setPen(QPen(style::alarm(palette), 1.5, Qt::DashLine));
    }
    canvas->xAxis->setRange(low, high);
    canvas->yAxis->setRange(0, highest * 1.15);
    canvas->xAxis->setLabel(unit);
    canvas->request_replot();
}

Histogram::Histogram(QWidget* parent) : QWidget(parent), impl_(std::make_unique<Impl>()) {
    setAccessibleName(tr("Distribution"));
    setToolTip(
        tr("Distribution with limits. Cp and Cpk assume independent values of one stable, normal process."));
    impl_->title = new QLabel(this);
    impl_->title->setAccessibleName(tr("Distribution in numbers"));
    impl_->title->setWordWrap(true);
    impl_->title->setContentsMargins(8, 4, 4, 0);
    impl_->canvas = new PlotCanvas(this);
    setFocusProxy(impl_->canvas);
    impl_->canvas->setAccessibleName(tr("Distribution chart"));
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    column->addWidget(impl_->title);
    column->addWidget(impl_->canvas, 1);
    QEvent event(QEvent::PaletteChange);
    changeEvent(&event);
}

Histogram::~Histogram() = default;

void Histogram::set_data(const QString& title, const QString& unit, const std::vector<double>& values,
                         const TrendLimits& limits, bool of_process) {
    impl_->of_process = of_process;
    impl_->name = title;
    impl_->unit = unit;
    impl_->values = values;
    impl_->limits = limits;
    impl_->rebuild();
}

const Capability& Histogram::shown() const {
    return impl_->shown;
}

void Histogram::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (!impl_ || !impl_->canvas) return;
    if (event->type() != QEvent::PaletteChange && event->type() != QEvent::FontChange) return;
    impl_->canvas->apply_style();
    impl_->canvas->xAxis->grid()->setVisible(false);
    impl_->rebuild();
}

}  // namespace seamwright
