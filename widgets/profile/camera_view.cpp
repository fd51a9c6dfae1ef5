#include "widgets/profile/camera_view.h"

#include <QElapsedTimer>
#include <QImage>
#include <QKeyEvent>
#include <QLabel>
#include <QMouseEvent>
#include <QPainter>
#include <QTimer>
#include <QVBoxLayout>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "widgets/style.h"
#include "widgets/view_bar.h"

namespace seamwright {

namespace {

unsigned grey_at(const StripeImage& image, int u, int v) {
    const std::byte* row = image.pixels + static_cast<std::size_t>(v) * image.row_bytes;
    if (image.bytes_per_pixel() == 1) return static_cast<unsigned>(row[u]);
    std::uint16_t value;
    std::memcpy(&value, row + 2 * static_cast<std::ptrdiff_t>(u), 2);
    return value;
}

template <class Value>
void count_rows(const StripeImage& image, GreyHistogram& histogram) {
    const unsigned full = static_cast<unsigned>(image.full_scale());
    const int shift = image.bit_depth - 6;
    int maximum = 0;
    for (int v = 0; v < image.height; ++v) {
        const std::byte* row = image.pixels + static_cast<std::size_t>(v) * image.row_bytes;
        for (int u = 0; u < image.width; ++u) {
            Value value;
            std::memcpy(&value, row + sizeof(Value) * static_cast<std::size_t>(u), sizeof(Value));
            const unsigned grey = std::min<unsigned>(value, full);
            ++histogram.classes[grey >> shift];
            histogram.saturated += grey == full;
            maximum = std::max(maximum, static_cast<int>(grey));
        }
    }
    histogram.maximum = maximum;
}

constexpr QSize kHistogram(208, 96);

}  // namespace

GreyHistogram grey_histogram(const StripeImage& image) {
    GreyHistogram histogram;
    if (image.empty()) return histogram;
    histogram.pixels = image.width * image.height;
    if (image.bytes_per_pixel() == 1)
        count_rows<std::uint8_t>(image, histogram);
    else
        count_rows<std::uint16_t>(image, histogram);
    return histogram;
}

// The picture's own surface.
class CameraSurface : public QWidget {
  public:
    CameraSurface(CameraView& view, QWidget* parent) : QWidget(parent), view_(view) {
        setFocusPolicy(Qt::StrongFocus);
        setAttribute(Qt::WA_OpaquePaintEvent);
        setMouseTracking(true);
        timer_.setSingleShot(true);
        QObject::connect(&timer_, &QTimer::timeout, this, [this] {
            since_.restart();
            update();
        });
        since_.start();
    }

    void changed() {
        if (!timer_.isActive()) timer_.start(std::max(0, 16 - static_cast<int>(since_.elapsed())));
    }

    void set_frame(const StripeImage& image, const StripePeaks* peaks) {
        if (image.empty()) {
            picture_ = QImage();
            histogram = {};
            peaks_.lines = 0;
            changed();
            return;
        }
        const bool other_size = picture_.size() != QSize(image.width, image.height);
        if (other_size) picture_ = QImage(image.width, image.height, QImage::Format_Indexed8);
        histogram = grey_histogram(image);
        const int shift = image.bit_depth - 8;
        const unsigned full = static_cast<unsigned>(image.full_scale());
        for (int v = 0; v < image.height; ++v) {
            uchar* to = picture_.scanLine(v);
            const std::byte* row = image.pixels + static_cast<std::size_t>(v) * image.row_bytes;
            if (shift == 0) {
                std::memcpy(to, row, static_cast<std::size_t>(image.width));
                continue;
            }
            // 255 is kept for saturated pixels alone.
            for (int u = 0; u < image.width; ++u) {
                const unsigned grey = grey_at(image, u, v);
                to[u] = grey >= full ? 255 : static_cast<uchar>(std::min(254U, grey >> shift));
            }
        }
        if (peaks)
            peaks_ = *peaks;
        else
            peaks_.lines = 0;
        if (other_size) {
            apply_style();
            fit();
        }
        changed();
    }

    void apply_style() {
        QList<QRgb> table(256);
        for (int i = 0; i < 255; ++i) table[i] = qRgb(i, i, i);
        table[255] = style::kVermilion;
        if (!picture_.isNull()) picture_.setColorTable(table);
        changed();
    }

    void fit() {
        if (picture_.isNull() || width() < 2) return;
        zoom_ = std::min(width() / static_cast<double>(picture_.width()),
                         height() / static_cast<double>(picture_.height()));
        origin_ =
            QPointF((width() - zoom_ * picture_.width()) / 2, (height() - zoom_ * picture_.height()) / 2);
        fitted_ = true;
        changed();
    }

    // Pixel centres on whole numbers: pixel 0 covers -0.5..0.5.
    QPointF to_widget(const QPointF& p) const { return origin_ + (p + QPointF(0.5, 0.5)) * zoom_; }
    QPointF to_pixel(const QPointF& w) const { return (w - origin_) / zoom_ - QPointF(0.5, 0.5); }

    GreyHistogram histogram;
    bool peaks_shown = true, histogram_shown = true, region_tool = false, stale = false;
    QRect region;

  protected:
    void paintEvent(QPaintEvent*) override {
        QPainter painter(this);
        painter.fillRect(rect(), style::is_dark(palette()) ? QColor(0x101214) : QColor(0x2a2e33));
        if (picture_.isNull()) {
            painter.setPen(QColor(0xe8ebee));
            painter.drawText(rect(), Qt::AlignCenter,
                             CameraView::tr("No camera image yet.\nThis sensor sends finished "
                                            "profiles, or its raw image is switched off."));
            return;
        }
        painter.setRenderHint(QPainter::SmoothPixmapTransform, false);
        painter.setOpacity(stale ? 0.4 : 1);
        painter.drawImage(QRectF(origin_, QSizeF(picture_.size()) * zoom_), picture_);
        painter.setOpacity(1);
        if (peaks_shown && !stale) paint_peaks(painter);
        if (!region.isNull()) {
            painter.setPen(QPen(QColor::fromRgb(style::kSkyBlue), 2, Qt::DashLine));
            painter.setBrush(Qt::NoBrush);
            painter.drawRect(QRectF(to_widget(QPointF(region.left() - 0.5, region.top() - 0.5)),
                                    QSizeF(region.size()) * zoom_));
        }
        if (histogram_shown) paint_histogram(painter);
    }

    void paint_peaks(QPainter& painter) {
        const int dot = zoom_ > 4 ? 5 : 2;
        for (int rank = 1; rank >= 0; --rank) {  // others first, strongest on top
            rectangles_.clear();
            for (int line = 0; line < peaks_.lines; ++line) {
                const int count = peaks_.count[static_cast<std::size_t>(line)];
                for (int k = rank == 0 ? 0 : 1; k < (rank == 0 ? std::min(count, 1) : count); ++k) {
                    const float position =
                        peaks_.position_px[static_cast<std::size_t>(peaks_.index(line, k))];
                    const QPointF pixel =
                        peaks_.scan == ScanLines::columns ? QPointF(line, position) : QPointF(position, line);
                    const QPointF at = to_widget(pixel);
                    rectangles_.emplace_back(at.x() - dot / 2.0, at.y() - dot / 2.0, dot, dot);
                }
            }
            painter.setPen(Qt::NoPen);
            painter.setBrush(QColor::fromRgb(rank == 0 ? style::kSkyBlue : style::kReddishPurple));
            painter.drawRects(rectangles_.data(), static_cast<int>(rectangles_.size()));
        }
    }

    void paint_histogram(QPainter& painter) {
        const int line = QFontMetrics(font()).height();
        const QRect box(width() - kHistogram.width() - 8, 8, kHistogram.width(), kHistogram.height() + line);
        painter.fillRect(box, QColor(16, 18, 20, 215));
        const int highest = *std::max_element(histogram.classes.begin(), histogram.classes.end());
        const double full = std::log1p(std::max(1, highest));
        painter.setPen(Qt::NoPen);
        for (std::size_t i = 0; i < histogram.classes.size(); ++i) {
            const int height =
                static_cast<int>((kHistogram.height() - 16) * std::log1p(histogram.classes[i]) / full);
            painter.setBrush(QColor(0xcfd6dd));
            painter.drawRect(QRect(box.left() + 8 + 3 * static_cast<int>(i),
                                   box.top() + kHistogram.height() - height - 4, 2, height));
        }
        painter.setPen(histogram.saturated ? QColor(0xff8a4c) : QColor(0xe8ebee));
        const double share = 100.0 * histogram.saturated / std::max(1, histogram.pixels);
        painter.drawText(
            box.adjusted(8, 0, -4, -3), Qt::AlignBottom | Qt::AlignLeft,
            histogram.saturated
                ? CameraView::tr("saturated %1 px (%2 %)").arg(histogram.saturated).arg(share, 0, 'f', 2)
                : CameraView::tr("not saturated, max %1").arg(histogram.maximum));
    }

    void mousePressEvent(QMouseEvent* event) override {
        press_ = event->position();
        press_origin_ = origin_;
        dragged_ = false;
    }
    void mouseMoveEvent(QMouseEvent* event) override {
        if (!(event->buttons() & (Qt::LeftButton | Qt::MiddleButton))) return;
        dragged_ = dragged_ || (event->position() - press_).manhattanLength() > 4;
        if (!dragged_) return;
        if (region_tool && (event->buttons() & Qt::LeftButton)) {
            region = dragged_region(event->position());
        } else {
            origin_ = press_origin_ + event->position() - press_;
            fitted_ = false;
        }
        changed();
    }
    void mouseReleaseEvent(QMouseEvent* event) override {
        if (dragged_ && region_tool) {
            if (!region.isEmpty()) emit view_.region_dragged(region);
            return;
        }
        if (dragged_ || picture_.isNull()) return;
        const QPointF p = to_pixel(event->position());
        const QPoint at(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
        if (picture_.rect().contains(at)) emit view_.pixel_picked(at, picture_.pixelIndex(at));
    }
    void mouseDoubleClickEvent(QMouseEvent*) override { fit(); }
    void wheelEvent(QWheelEvent* event) override {
        zoom_by(std::pow(1.2, event->angleDelta().y() / 120.0), event->position());
        event->accept();
    }
    void keyPressEvent(QKeyEvent* event) override {
        switch (event->key()) {
            case Qt::Key_F:
                fit();
                return;
            case Qt::Key_Plus:
            case Qt::Key_Equal:
                zoom_by(1.25, QRectF(rect()).center());
                return;
            case Qt::Key_Minus:
                zoom_by(0.8, QRectF(rect()).center());
                return;
            case Qt::Key_Left:
                move_by({40, 0});
                return;
            case Qt::Key_Right:
                move_by({-40, 0});
                return;
            case Qt::Key_Up:
                move_by({0, 40});
                return;
            case Qt::Key_Down:
                move_by({0, -40});
                return;
            default:
                QWidget::keyPressEvent(event);
        }
    }
    void resizeEvent(QResizeEvent* event) override {
        QWidget::resizeEvent(event);
        if (fitted_) fit();
    }

  private:
    QRect dragged_region(const QPointF& to) const {
        const QPointF a = to_pixel(press_), b = to_pixel(to);
        const QPoint low(static_cast<int>(std::lround(std::min(a.x(), b.x()))),
                         static_cast<int>(std::lround(std::min(a.y(), b.y()))));
        const QPoint high(static_cast<int>(std::lround(std::max(a.x(), b.x()))),
                          static_cast<int>(std::lround(std::max(a.y(), b.y()))));
        return QRect(low, high) & picture_.rect();
    }
    void zoom_by(double factor, const QPointF& about) {
        const double zoom = std::clamp(zoom_ * factor, 0.02, 64.0);
        origin_ = about - (about - origin_) * (zoom / zoom_);
        zoom_ = zoom;
        fitted_ = false;
        changed();
    }
    void move_by(const QPointF& step) {
        origin_ += step;
        fitted_ = false;
        changed();
    }

    CameraView& view_;
    QImage picture_;
    StripePeaks peaks_;
    std::vector<QRectF> rectangles_;
    QTimer timer_;
    QElapsedTimer since_;
    double zoom_ = 1;
    QPointF origin_, press_, press_origin_;
    bool dragged_ = false, fitted_ = true;
};

struct CameraView::Impl {
    CameraSurface* surface = nullptr;
    QWidget* toolbar = nullptr;
    QLabel* caption = nullptr;
    QToolButton *peaks = nullptr, *histogram = nullptr, *region = nullptr;
};

CameraView::CameraView(QWidget* parent) : QWidget(parent), impl_(std::make_unique<Impl>()) {
    setObjectName("camera_view");
    setAccessibleName(tr("Camera image"));
    setToolTip(tr("The sensor's raw image with the peaks found. Drag moves, wheel zooms, F fits."));
    impl_->surface = new CameraSurface(*this, this);
    impl_->surface->setAccessibleName(tr("Camera image, pixels"));
    setFocusProxy(impl_->surface);
    auto* bar = new ViewBar(this);
    impl_->toolbar = bar;
    impl_->caption = bar->caption();
    impl_->caption->setAccessibleName(tr("Camera state"));
    auto* fit_button = bar->add(tr("Fit"), tr("Show the whole image (F)"), false);
    impl_->region = bar->add(tr("Region"), tr("Drag the region of interest"), true);
    impl_->peaks = bar->add(tr("Peaks"), tr("Peaks: strongest blue, others purple"), true);
    impl_->histogram = bar->add(tr("Histogram"), tr("Grey values, logarithmic, and saturated pixels"), true);
    impl_->peaks->setChecked(true);
    impl_->histogram->setChecked(true);
    connect(fit_button, &QToolButton::clicked, this, &CameraView::fit);
    connect(impl_->region, &QToolButton::toggled, this, &CameraView::set_region_tool);
    connect(impl_->peaks, &QToolButton::toggled, this, &CameraView::set_peaks_shown);
    connect(impl_->histogram, &QToolButton::toggled, this, &CameraView::set_histogram_shown);
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    column->addWidget(impl_->toolbar);
    column->addWidget(impl_->surface, 1);
}

CameraView::~CameraView() = default;

void CameraView::set_frame(const StripeImage& image, const StripePeaks* peaks) {
    impl_->surface->set_frame(image, peaks);
}
void CameraView::set_stale(bool stale) {
    if (impl_->surface->stale == stale) return;
    impl_->surface->stale = stale;
    impl_->surface->changed();
}
void CameraView::set_peaks_shown(bool shown) {
    impl_->surface->peaks_shown = shown;
    impl_->peaks->setChecked(shown);
    impl_->surface->changed();
}
void CameraView::set_histogram_shown(bool shown) {
    impl_->surface->histogram_shown = shown;
    impl_->histogram->setChecked(shown);
    impl_->surface->changed();
}
void CameraView::set_region_tool(bool on) {
    impl_->surface->region_tool = on;
    impl_->region->setChecked(on);
    impl_->surface->setCursor(on ? Qt::CrossCursor : Qt::ArrowCursor);
}
void CameraView::set_region(const QRect& region_px) {
    impl_->surface->region = region_px;
    impl_->surface->changed();
}
QRect CameraView::region() const {
    return impl_->surface->region;
}
void CameraView::set_caption(const QString& caption) {
    impl_->caption->setText(caption);
    // It never shrinks: the buttons beside it stay where they are while the rate changes.
    impl_->caption->setMinimumWidth(
        std::max(impl_->caption->minimumWidth(), impl_->caption->sizeHint().width()));
}
void CameraView::set_toolbar_shown(bool shown) {
    impl_->toolbar->setVisible(shown);
}
void CameraView::fit() {
    impl_->surface->fit();
}
const GreyHistogram& CameraView::histogram() const {
    return impl_->surface->histogram;
}
QPointF CameraView::to_screen(const QPointF& pixel) const {
    return impl_->surface->mapTo(this, impl_->surface->to_widget(pixel));
}
QPointF CameraView::from_screen(const QPointF& position) const {
    return impl_->surface->to_pixel(impl_->surface->mapFrom(this, position));
}
void CameraView::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::PaletteChange && impl_) impl_->surface->apply_style();
}

}  // namespace seamwright
