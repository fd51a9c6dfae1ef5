#include "widgets/align/align_view.h"

#include <QButtonGroup>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QScrollArea>
#include <QScrollBar>
#include <QSplitter>
#include <QVBoxLayout>
#include <cmath>

#include "widgets/align/align_canvas.h"
#include "widgets/align/cure_arrow.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"
#include "widgets/view_bar.h"

namespace seamwright {

namespace {
constexpr int kSide_px = 300;       // verdict and numbers
constexpr int kBothPlots_px = 340;  // of height, below which the offsets alone are drawn
constexpr int kStack_px = 90;       // of the profiles of the pass, at least
}  // namespace

struct AlignView::Impl {
    OffsetCanvas* offsets = nullptr;
    StackCanvas* stack = nullptr;
    QWidget* lower = nullptr;  // with the stack
    CureArrow* arrow = nullptr;
    QLabel *verdict = nullptr, *reason = nullptr;
    QLabel *yaw = nullptr, *pitch = nullptr, *roll = nullptr, *radius = nullptr, *error = nullptr,
           *tolerance = nullptr, *shape = nullptr;
    QToolButton *as_image = nullptr, *as_overlay = nullptr;
    enum class Mood { none, good, attention, alarm } mood = Mood::none;

    void paint_verdict(const QPalette& palette) {
        const QColor colour = mood == Mood::good        ? style::good(palette)
                              : mood == Mood::attention ? style::attention(palette)
                              : mood == Mood::alarm     ? style::alarm(palette)
                                                        : style::quiet_text(palette);
        QPalette own = palette;
        own.setColor(QPalette::WindowText, colour);
        verdict->setPalette(own);
    }
    // As large as the longest word of it allows.
    void fit_verdict() {
        QFont big = verdict->parentWidget()->font();
        big.setBold(true);
        for (double size = std::max(22.0, 2.2 * big.pointSizeF()); size >= 11; size -= 0.5) {
            big.setPointSizeF(size);
            int widest = 0;
            for (const QString& one : verdict->text().split(' '))
                widest = std::max(widest, QFontMetrics(big).horizontalAdvance(one));
            if (widest <= kSide_px - 32) break;
        }
        verdict->setFont(big);
    }
    void say(const QString& word, const QString& why, Mood with, const QPalette& palette) {
        verdict->setText(word);
        fit_verdict();
        reason->setText(why);
        mood = with;
        paint_verdict(palette);
    }
};

AlignView::AlignView(QWidget* parent) : QWidget(parent), impl_(std::make_unique<Impl>()) {
    setObjectName("align_view");
    setAccessibleName(tr("Frozen contour"));
    setToolTip(tr("Does the contour stand still while the robot passes the spot?"));
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(0, 0, 0, 0);
    row->setSpacing(12);
    auto* split = new QSplitter(Qt::Vertical, this);
    split->setChildrenCollapsible(false);
    impl_->offsets = new OffsetCanvas(split);
    setFocusProxy(impl_->offsets);
    impl_->offsets->setToolTip(
        tr("Drag either blue line, or press Left and Right: how far the trigger may miss"));
    auto* lower = impl_->lower = new QWidget(split);
    auto* lower_column = new QVBoxLayout(lower);
    lower_column->setContentsMargins(0, 0, 0, 0);
    lower_column->setSpacing(0);
    auto* head = new ViewBar(lower);  // without a caption its buttons keep one line; the axes say what it is
    auto* group = new QButtonGroup(this);
    impl_->as_image = head->add(
        tr("Image"), tr("x to the right, travel upwards, height as colour: upright bands stand still"), true);
    impl_->as_overlay = head->add(
        tr("Overlay"), tr("All profiles over each other; the live one thin over the frozen one"), true);
    group->addButton(impl_->as_image);
    group->addButton(impl_->as_overlay);
    impl_->as_image->setChecked(true);
    connect(impl_->as_image, &QToolButton::clicked, this, [this] { set_stack(Stack::image); });
    connect(impl_->as_overlay, &QToolButton::clicked, this, [this] { set_stack(Stack::overlay); });
    lower_column->addWidget(head);
    impl_->stack = new StackCanvas(lower);
    impl_->stack->setMinimumHeight(kStack_px);
    impl_->stack->setToolTip(
        tr("Every profile of the pass over the travel; the buttons above change the picture"));
    lower_column->addWidget(impl_->stack, 1);
    split->addWidget(impl_->offsets);
    split->addWidget(lower);
    split->setStretchFactor(0, 1);
    split->setStretchFactor(1, 1);
    split->setSizes({300, 300});
    row->addWidget(split, 1);

    auto* side_scroll = new QScrollArea(this);
    side_scroll->setFrameShape(QFrame::NoFrame);
    side_scroll->setWidgetResizable(true);
    side_scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    side_scroll->setFixedWidth(kSide_px + side_scroll->verticalScrollBar()->sizeHint().width());
    side_scroll->setFocusPolicy(Qt::NoFocus);
    auto* side = new QWidget;
    side_scroll->setWidget(side);
    auto* column = new QVBoxLayout(side);
    column->setContentsMargins(4, 8, 8, 8);
    column->setSpacing(6);
    impl_->verdict = new QLabel(side);
    impl_->verdict->setAccessibleName(tr("Verdict"));
    impl_->verdict->setWordWrap(true);
    column->addWidget(impl_->verdict);
    impl_->reason = new QLabel(side);
    impl_->reason->setAccessibleName(tr("Reason and cure"));
    impl_->reason->setWordWrap(true);
    column->addWidget(impl_->reason);
    auto* grid = new QGridLayout;
    grid->setVerticalSpacing(5);
    grid->setContentsMargins(0, 8, 0, 8);
    int line = 0;
    const auto number = [&](const QString& name, const QString& tip) {
        // The word gives way to the number, which is never cut.
        auto* label = new QLabel(name, side);
        label->setWordWrap(true);
        auto* value = new QLabel(side);
        value->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
        value->setAccessibleName(name);
        value->setTextInteractionFlags(Qt::TextSelectableByMouse);
        value->setFocusPolicy(Qt::NoFocus);
        for (QLabel* one : {label, value}) one->setToolTip(tip);
        grid->addWidget(label, line, 0);
        grid->addWidget(value, line, 1);
        ++line;
        return value;
    };
    impl_->yaw = number(tr("Yaw"), tr("atan(dx/dy), sensor frame, ± sigma"));
    impl_->pitch = number(tr("Pitch"), tr("atan(dz/dy), sensor frame, ± sigma"));
    impl_->roll = number(tr("Twist"), tr("Turn of the profile over the jitter's half width"));
    impl_->radius = number(tr("Local radius"), tr("Of the contour's own curvature along the travel"));
    impl_->error = number(tr("Error from jitter"), tr("Largest shift within the jitter window"));
    impl_->tolerance =
        number(tr("Tolerance"), tr("What the jitter may cause at most, and the window it was judged over"));
    impl_->shape = number(tr("Shape change"), tr("What remains after the profiles are laid over each other"));
    grid->setColumnStretch(0, 1);
    impl_->arrow = new CureArrow(side);
    column->addWidget(impl_->arrow);
    column->addLayout(grid);
    column->addStretch(1);
    row->addWidget(side_scroll);

    impl_->offsets->on_jitter = [this](double half) { emit jitter_dragged(half); };
    impl_->offsets->on_travel = [this](double travel) { emit travel_picked(travel); };
    QEvent event(QEvent::FontChange);
    changeEvent(&event);
    clear();
}

AlignView::~AlignView() = default;

void AlignView::clear() {
    impl_->offsets->clear();
    impl_->stack->set_pass({});
    impl_->arrow->set_cure(0, 0, false);
    impl_->arrow->hide();
    for (QLabel* label :
         {impl_->yaw, impl_->pitch, impl_->roll, impl_->radius, impl_->error, impl_->tolerance, impl_->shape})
        label->setText(QStringLiteral("–"));
    impl_->say(tr("NOT RECORDED"), tr("Run the robot slowly from entry over the trigger to the exit."),
               Impl::Mood::none, palette());
}

void AlignView::set_recording(std::span<const TravelProfile> pass) {
    impl_->stack->set_pass(pass);
    impl_->say(tr("RECORDING"), tr("%n profiles so far", nullptr, static_cast<int>(pass.size())),
               Impl::Mood::none, palette());
}

void AlignView::set_result(std::span<const TravelProfile> pass, const AlignmentResult& result,
                           const AlignmentOptions& options, bool widened) {
    impl_->stack->set_pass(pass);
    impl_->offsets->set_data(result, options);
    const auto angle = [](double degrees, double sigma) {
        QString text = QStringLiteral("%1%2°").arg(degrees >= 0 ? "+" : "").arg(degrees, 0, 'f', 2);
        if (std::isfinite(sigma)) text += QStringLiteral("  ± %1").arg(sigma, 0, 'f', 2);
        return text;
    };
    const bool judged = result.status != AlignmentStatus::not_enough_profiles;
    impl_->yaw->setText(!judged                               ? QStringLiteral("–")
                        : std::isfinite(result.sigma_yaw_deg) ? angle(result.yaw_deg, result.sigma_yaw_deg)
                                                              : tr("not seen"));
    impl_->pitch->setText(!judged ? QStringLiteral("–")
                          : std::isfinite(result.sigma_pitch_deg)
                              ? angle(result.pitch_deg, result.sigma_pitch_deg)
                              : tr("not seen"));
    impl_->roll->setText(judged ? angle(result.roll_deg, NAN) : QStringLiteral("–"));
    impl_->radius->setText(!judged                            ? QStringLiteral("–")
                           : !std::isfinite(result.radius_mm) ? tr("straight")
                           : result.radius_mm >= 1000 ? tr("%1 m").arg(result.radius_mm / 1000, 0, 'f', 2)
                                                      : tr("%1 mm").arg(result.radius_mm, 0, 'f', 0));
    impl_->error->setText(judged ? tr("%1 mm").arg(result.expected_error_mm, 0, 'f', 3)
                                 : QStringLiteral("–"));
    impl_->tolerance->setText(
        tr("%1 mm / ±%2 mm").arg(options.tolerance_mm, 0, 'f', 2).arg(options.jitter_mm, 0, 'f', 1));
    impl_->shape->setText(judged ? tr("%1 mm").arg(result.shape_change_mm, 0, 'f', 3) : QStringLiteral("–"));
    const bool drifting = result.status == AlignmentStatus::drifting;
    impl_->arrow->set_cure(result.cure_about_z_deg, result.cure_about_x_deg, drifting);
    impl_->arrow->setVisible(drifting);
    const QString cure = shown(result.cure);
    switch (result.status) {
        case AlignmentStatus::frozen:
            if (widened)
                impl_->say(tr("WIDENED"),
                           tr("The contour stands still within a tolerance that is wider than the project "
                              "requires."),
                           Impl::Mood::attention, palette());
            else
                impl_->say(tr("FROZEN"), tr("The contour stands still within the tolerance."),
                           Impl::Mood::good, palette());
            break;
        case AlignmentStatus::drifting:
            impl_->say(tr("DRIFTING"),
                       cure.isEmpty() ? tr("The jitter causes more than the tolerance.") : cure,
                       Impl::Mood::alarm, palette());
            break;
        case AlignmentStatus::shape_changes:
            impl_->say(tr("SHAPE CHANGES"),
                       cure.isEmpty()
                           ? tr("The profile changes its shape within the jitter: move the spot along the "
                                "contour.")
                           : cure,
                       Impl::Mood::attention, palette());
            break;
        case AlignmentStatus::not_enough_profiles:
            impl_->say(tr("TOO FEW PROFILES"),
                       tr("Fewer than 5 usable profiles, or less than 1 mm of travel: record the pass again, "
                          "slower."),
                       Impl::Mood::attention, palette());
            break;
        case AlignmentStatus::undetermined:
            impl_->say(tr("UNDETERMINED"), tr("What is seen does not tell whether the contour stands still."),
                       Impl::Mood::attention, palette());
            break;
    }
    if (result.sliding)
        impl_->reason->setText(impl_->reason->text() + "\n" +
                               tr("The profile is a straight line: only the drift across it is seen."));
}

void AlignView::set_live(const Profile& profile) {
    impl_->stack->set_live(profile);
}

void AlignView::set_stack(Stack stack) {
    impl_->stack->overlay = stack == Stack::overlay;
    (impl_->stack->overlay ? impl_->as_overlay : impl_->as_image)->setChecked(true);
    impl_->stack->rebuild();
}

AlignView::Stack AlignView::stack() const {
    return impl_->stack->overlay ? Stack::overlay : Stack::image;
}
double AlignView::jitter_mm() const {
    return impl_->offsets->jitter_mm;
}
QString AlignView::verdict() const {
    return impl_->verdict->text();
}

void AlignView::resizeEvent(QResizeEvent* event) {
    QWidget::resizeEvent(event);
    impl_->lower->setVisible(height() >= kBothPlots_px);
}

void AlignView::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (!impl_ || !impl_->verdict) return;
    if (event->type() == QEvent::PaletteChange) impl_->paint_verdict(palette());
    if (event->type() == QEvent::FontChange) impl_->fit_verdict();
}

}  // namespace seamwright
