#include "widgets/charts/trend_chart.h"

#include <QKeyEvent>
#include <QLabel>
#include <QMouseEvent>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "widgets/plot_canvas.h"
#include "widgets/style.h"

namespace seamwright {

namespace {

constexpr QCPScatterStyle::ScatterShape kShapes[] = {QCPScatterStyle::ssDisc,     QCPScatterStyle::ssSquare,
                                                     QCPScatterStyle::ssTriangle, QCPScatterStyle::ssDiamond,
                                                     QCPScatterStyle::ssPlus,     QCPScatterStyle::ssCross};

bool beyond(double value, const TrendLimits& limits) {
    return (limits.lower && value < *limits.lower) || (limits.upper && value > *limits.upper);
}

// Names as many parts below the axis as find room beside one another.
class PartsCanvas final : public PlotCanvas {
  public:
    using PlotCanvas::PlotCanvas;
    const std::vector<QString>* labels = nullptr;

  protected:
    void view_changed() override {
        if (!labels) return;
        const QFontMetrics metrics(xAxis->tickLabelFont());
        int widest = 1;
        for (const QString& label : *labels) widest = std::max(widest, metrics.horizontalAdvance(label));
        const auto parts = static_cast<int>(labels->size());
        const int room = std::max(1, axisRect()->width() / (widest + 2 * metrics.averageCharWidth()));
        const int step = std::max(1, (parts + room - 1) / room);
        QSharedPointer<QCPAxisTickerText> ticker(new QCPAxisTickerText);
        for (int i = 0; i < parts; i += step) ticker->addTick(i, (*labels)[static_cast<std::size_t>(i)]);
        xAxis->setTicker(ticker);
    }
};

}  // namespace

struct TrendChart::Impl {
    PartsCanvas* canvas = nullptr;
    QLabel* title = nullptr;
    QString name, unit;
    std::vector<QString> labels;
    std::vector<TrendSeries> series;
    TrendLimits limits;
    int beyond_count = 0, marked = -1;

    void rebuild();
    void mark(int part);
};

void TrendChart::Impl::rebuild() {
    const QPalette palette = canvas->parentWidget()->palette();
    canvas->clearPlottables();
    canvas->clearItems();
    const auto parts = static_cast<int>(labels.size());
    beyond_count = 0;
    double low = 0, high = 0;
    bool first = true;
    const auto reach = [&](double v) {
        low = first ? v : std::min(low, v);
        high = first ? v : std::max(high, v);
        first = false;
    };
    if (limits.lower) reach(*limits.lower);
    if (limits.upper) reach(*limits.upper);
    auto* ring = canvas->addGraph();
    ring->setLineStyle(QCPGraph::lsNone);
    ring->setScatterStyle(
        QCPScatterStyle(QCPScatterStyle::ssCircle, QPen(style::alarm(palette), 2), Qt::NoBrush, 13));
    ring->removeFromLegend();
    int number = 0;
    for (const TrendSeries& one : series) {
        auto* graph = canvas->addGraph();
        const QColor colour = style::segment(number, palette);
        graph->setName(one.name);
        QColor line = colour;
        line.setAlpha(90);
        graph->setPen(QPen(line, 1));
        const auto shape = kShapes[static_cast<std::size_t>(number) % std::size(kShapes)];
        graph->setScatterStyle(QCPScatterStyle(shape, QPen(colour, 1.5), QBrush(colour), 6));
        for (int i = 0; i < parts && i < static_cast<int>(one.values.size()); ++i) {
            const double v = one.values[static_cast<std::size_t>(i)];
            graph->addData(i, v);  // NaN leaves a gap
            if (!std::isfinite(v)) continue;
            reach(v);
            if (!beyond(v, limits)) continue;
            ring->addData(i, v);
            ++beyond_count;
        }
        ++number;
    }
    const auto limit_line = [&](const std::optional<double>& limit, const QString& word) {
        if (!limit) return;
        auto* line = new QCPItemStraightLine(canvas);
        line->point1->setCoords(0, *limit);
        line->point2->setCoords(1, *limit);
        line->setPen(QPen(style::alarm(palette), 1.5, Qt::DashLine));
        auto* text = new QCPItemText(canvas);
        text->position->setTypeX(QCPItemPosition::ptAxisRectRatio);
        text->position->setTypeY(QCPItemPosition::ptPlotCoords);
        text->position->setCoords(0.01, *limit);
        text->setPositionAlignment(
            Qt::AlignLeft | (limits.upper && *limit == *limits.upper ? Qt::AlignTop : Qt::AlignBottom));
        text->setText(QString("%1 %2").arg(word, QString::number(*limit, 'g', 4)));
        text->setColor(style::alarm(palette));
        text->setFont(canvas->font());
    };
    int missing = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(parts); ++i)
        missing += std::none_of(series.begin(), series.end(), [&](const TrendSeries& one) {
            return i < one.values.size() && std::isfinite(one.values[i]);
        });
    limit_line(limits.lower, TrendChart::tr("lower limit"));
    limit_line(limits.upper, TrendChart::tr("upper limit"));
    if (marked >= 0 && marked < parts) {
        auto* line = new QCPItemStraightLine(canvas);
        line->point1->setCoords(marked, 0);
        line->point2->setCoords(marked, 1);
        line->setPen(QPen(style::selection(palette), 1.5));
    }
    canvas->xAxis->setRange(-0.6, std::max(1.0, parts - 0.4));
    const double margin = std::max(1e-9, 0.12 * (high - low)) + (high > low ? 0 : 1);
    canvas->yAxis->setRange(low - margin, high + margin);
    canvas->yAxis->setLabel(unit);
    canvas->legend->setVisible(series.size() > 1);
    QString text = name;
    if (parts == 0)
        text += "   " + TrendChart::tr("no parts yet");
    else if (beyond_count > 0)
        text += "   " + TrendChart::tr("%n beyond limits", nullptr, beyond_count);
    else if (limits.lower || limits.upper)
        text += "   " + (missing > 0 ? TrendChart::tr("%n without a value, the others within limits", nullptr,
                                                      missing)
                                     : TrendChart::tr("all values within limits"));
    if (marked >= 0 && marked < parts) text += "   " + labels[static_cast<std::size_t>(marked)];
    title->setText(text);
    canvas->request_replot();
}

void TrendChart::Impl::mark(int part) {
    marked = labels.empty() ? -1 : std::clamp(part, 0, static_cast<int>(labels.size()) - 1);
    rebuild();
}

TrendChart::TrendChart(QWidget* parent) : QWidget(parent), impl_(std::make_unique<Impl>()) {
    setAccessibleName(tr("History over parts"));
    setToolTip(tr("One mark per part. A click opens the part; Left and Right move, Enter opens."));
    impl_->title = new QLabel(this);
    impl_->title->setAccessibleName(tr("Chart title"));
    impl_->title->setContentsMargins(8, 4, 4, 0);
    impl_->title->setWordWrap(true);
    impl_->canvas = new PartsCanvas(this);
    impl_->canvas->labels = &impl_->labels;
    impl_->canvas->setAccessibleName(tr("History chart"));
    setFocusProxy(impl_->canvas);
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    column->addWidget(impl_->title);
    column->addWidget(impl_->canvas, 1);
    QCPLegend* legend = impl_->canvas->legend;
    legend->setBorderPen(Qt::NoPen);
    legend->setBrush(Qt::NoBrush);
    legend->setFillOrder(QCPLegend::foColumnsFirst);
    impl_->canvas->axisRect()->insetLayout()->setInsetAlignment(0, Qt::AlignTop | Qt::AlignRight);
    connect(impl_->canvas, &QCustomPlot::mouseRelease, this, [this](QMouseEvent* event) {
        if (event->button() != Qt::LeftButton || impl_->labels.empty()) return;
        const int part =
            static_cast<int>(std::lround(impl_->canvas->xAxis->pixelToCoord(event->position().x())));
        if (part < 0 || part >= static_cast<int>(impl_->labels.size())) return;
        impl_->mark(part);
        emit part_opened(part);
    });
    QEvent event(QEvent::PaletteChange);
    changeEvent(&event);
}

TrendChart::~TrendChart() = default;

void TrendChart::set_data(const QString& title, const QString& unit, const std::vector<QString>& labels,
                          const std::vector<TrendSeries>& series, const TrendLimits& limits) {
    impl_->name = title;
    impl_->unit = unit;
    impl_->labels = labels;
    impl_->series = series;
    impl_->limits = limits;
    impl_->marked = -1;
    impl_->rebuild();
}

int TrendChart::beyond_limits() const {
    return impl_->beyond_count;
}

QPointF TrendChart::to_screen(int part, double value) const {
    return impl_->canvas->mapTo(
        this, QPointF(impl_->canvas->xAxis->coordToPixel(part), impl_->canvas->yAxis->coordToPixel(value)));
}

void TrendChart::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (!impl_ || !impl_->canvas) return;
    if (event->type() != QEvent::PaletteChange && event->type() != QEvent::FontChange) return;
    impl_->canvas->apply_style();
    impl_->canvas->xAxis->grid()->setVisible(false);
    impl_->canvas->legend->setFont(font());
    impl_->canvas->legend->setTextColor(style::quiet_text(palette()));
    impl_->rebuild();
}

void TrendChart::keyPressEvent(QKeyEvent* event) {
    const int last = static_cast<int>(impl_->labels.size()) - 1;
    switch (event->key()) {
        case Qt::Key_Left:
            impl_->mark(impl_->marked < 0 ? last : impl_->marked - 1);
            return;
        case Qt::Key_Right:
            impl_->mark(impl_->marked < 0 ? 0 : impl_->marked + 1);
            return;
        case Qt::Key_Return:
        case Qt::Key_Enter:
            if (impl_->marked >= 0) emit part_opened(impl_->marked);
            return;
        default:
            QWidget::keyPressEvent(event);
    }
}

}  // namespace seamwright
