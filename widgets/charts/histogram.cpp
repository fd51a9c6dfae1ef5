#include "widgets/charts/histogram.h"

#include <QLabel>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "widgets/plot_canvas.h"
#include "widgets/style.h"

namespace seamwright {

namespace {

QString in_words(double v) {
    return QString::number(v, 'f', 3);
}

std::vector<double> finite_sorted(const std::vector<double>& values) {
    std::vector<double> sorted;
    for (const double v : values)
        if (std::isfinite(v)) sorted.push_back(v);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
}

// Freedman-Diaconis; 0: all are equal, or fewer than two.
double class_width(const std::vector<double>& sorted) {
    const std::size_t n = sorted.size();
    if (n < 2) return 0;
    const double width = 2 * (sorted[n * 3 / 4] - sorted[n / 4]) / std::cbrt(static_cast<double>(n));
    return width > 0 ? width : (sorted.back() - sorted.front()) / 5;
}

}  // namespace

struct Histogram::Impl {
    bool of_process = true;
    PlotCanvas* canvas = nullptr;
    QLabel* title = nullptr;
    QString name, unit;
    std::vector<TrendSeries> series;
    TrendLimits limits;
    std::vector<ShownCapability> shown;  // one a series

    void rebuild();
    QString words(const ShownCapability& of) const;
};

QString Histogram::Impl::words(const ShownCapability& of) const {
    if (of.count < 2) return Histogram::tr("fewer than two values");
    QString text = Histogram::tr("n %1   mean %2   s %3 %4")
                       .arg(of.count)
                       .arg(in_words(of.mean), in_words(of.standard_deviation), unit);
    if (of_process && of.cp) text += "   " + Histogram::tr("Cp %1").arg(*of.cp, 0, 'f', 2);
    if (of_process && of.cpk) text += "   " + Histogram::tr("Cpk %1").arg(*of.cpk, 0, 'f', 2);
    if (of_process && of.cpk && of.count < 50) text += " " + Histogram::tr("(few values)");
    return text;
}

void Histogram::Impl::rebuild() {
    const QPalette palette = canvas->parentWidget()->palette();
    canvas->clearPlottables();
    canvas->clearItems();
    shown.clear();
    std::vector<std::vector<double>> sorted;
    double width = 0, first = 0, last = 0;
    bool any = false;
    QStringList lines;
    for (const TrendSeries& s : series) {
        shown.push_back(capability(s.values, limits));
        lines << (s.name.isEmpty() ? words(shown.back()) : s.name + "   " + words(shown.back()));
        sorted.push_back(finite_sorted(s.values));
        const std::vector<double>& own = sorted.back();
        if (own.size() < 2) continue;
        const double fine = class_width(own);
        if (fine > 0 && (width == 0 || fine < width)) width = fine;
        first = any ? std::min(first, own.front()) : own.front();
        last = any ? std::max(last, own.back()) : own.back();
        any = true;
    }
    if (!any) {
        title->setText(name + "\n" + Histogram::tr("fewer than two values"));
        canvas->request_replot();
        return;
    }
    title->setText(series.size() == 1 ? name + "   " + lines.front() : name + "\n" + lines.join('\n'));

    // The series share the classes, and their bars a class.
    const double whole = last - first;
    const int classes = width > 0 ? std::clamp(static_cast<int>(std::ceil(whole / width)), 5, 60) : 5;
    width = whole > 0 ? whole / classes : 1;
    const auto beside = static_cast<double>(series.size());
    double low = first - width, high = last + width, highest = 0;
    if (limits.lower) low = std::min(low, *limits.lower - width);
    if (limits.upper) high = std::max(high, *limits.upper + width);
    for (std::size_t k = 0; k < series.size(); ++k) {
        const std::vector<double>& own = sorted[k];
        if (own.size() < 2) continue;
        const QColor colour = style::segment(static_cast<int>(k), palette);
        QVector<double> keys(classes), counts(classes, 0.0);
        for (int i = 0; i < classes; ++i)
            keys[i] = first + (i + (static_cast<double>(k) + 0.5) / beside) * width;
        for (const double v : own)
            counts[std::clamp(static_cast<int>((v - first) / width), 0, classes - 1)] += 1;
        auto* bars = new QCPBars(canvas->xAxis, canvas->yAxis);
        bars->setWidthType(QCPBars::wtPlotCoords);
        bars->setWidth(width * 0.94 / beside);
        bars->setPen(Qt::NoPen);
        bars->setBrush(colour);
        bars->setData(keys, counts, true);
        highest = std::max(highest, *std::max_element(counts.begin(), counts.end()));

        // The normal curve that Cp and Cpk assume, for the eye to judge.
        const ShownCapability& of = shown[k];
        if (!(of.standard_deviation > 0)) continue;
        auto* curve = canvas->addGraph();
        curve->setPen(QPen(series.size() == 1 ? style::quiet_text(palette) : colour, 1.5));
        constexpr double kSqrt2Pi = 2.5066282746310002;
        for (int i = 0; i <= 160; ++i) {
            const double x = low + (high - low) * i / 160;
            const double u = (x - of.mean) / of.standard_deviation;
            curve->addData(x, static_cast<double>(own.size()) * width / (of.standard_deviation * kSqrt2Pi) *
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
    set_data(title, unit, std::vector<TrendSeries>{{{}, values}}, limits, of_process);
}

void Histogram::set_data(const QString& title, const QString& unit, const std::vector<TrendSeries>& series,
                         const TrendLimits& limits, bool of_process) {
    impl_->of_process = of_process;
    impl_->name = title;
    impl_->unit = unit;
    impl_->series = series;
    impl_->limits = limits;
    impl_->rebuild();
}

const ShownCapability& Histogram::shown(std::size_t series) const {
    static const ShownCapability none;
    return series < impl_->shown.size() ? impl_->shown[series] : none;
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
