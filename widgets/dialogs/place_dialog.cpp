#include "widgets/dialogs/place_dialog.h"

#include <QFileDialog>
#include <QFileInfo>
#include <QPointer>
#include <QVBoxLayout>
#include <algorithm>

#include "devices/exchange/files.h"
#include "projects/measure/measure.h"
#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {
namespace {

constexpr int kPlaceDialogWidth = 760;
constexpr int kRowsSeen = 5;       // of the table, at least
constexpr double kSmooth_deg = 3;  // less of a fold is none to the eye
constexpr int kMostSpots = 40;
constexpr double kAllAlong_mm = 10000;
constexpr double kChord_mm = 0.02;  // as `seamwright propose` reads drawings

QString words_of(const DrawingEdge& edge) {
    return PlaceDialog::tr("%1 mm, %2")
        .arg(number(edge.length_mm, 0),
             edge.fold_deg > 0    ? PlaceDialog::tr("fold of %1 degrees").arg(number(edge.fold_deg, 0))
             : edge.right.empty() ? PlaceDialog::tr("free border")
                                  : PlaceDialog::tr("smooth"));
}

}  // namespace

PlaceDialog::PlaceDialog(Desk& desk, SceneView& scene, QWidget* parent)
    : QDialog(parent), desk_(desk), scene_(scene) {
    setObjectName("place_dialog");
    setWindowTitle(tr("Spots from the drawing"));
    setMinimumWidth(kPlaceDialogWidth);
    auto* box = new QVBoxLayout(this);
    file_ = new QLineEdit;
    file_->setObjectName("place_file");
    file_->setReadOnly(true);
    add_field(*box, tr("Drawing"), file_, tr("STEP, IGES, STL, PLY or OBJ, in the work object"));
    choose_ = make_button("place_choose", "open", tr("Choose the drawing..."),
                          tr("STEP, IGES, STL, PLY or OBJ, in the work object"), [this] { choose_file(); });
    box->addLayout(make_row({choose_}));
    edge_ = new QComboBox;
    edge_->setObjectName("place_edge");
    add_field(
        *box, tr("Edge of the bead"), edge_,
        tr("The bead follows it. Or click it in the 3D view; spots stand along its chain of tangent edges."));
    region_ = new QComboBox;
    region_->setObjectName("place_region");
    add_field(*box, tr("For the region"), region_,
              tr("Its limits and free degrees hold, and it takes the spots"));
    // What is asked for on the left, how on the right.
    auto *asked = new QVBoxLayout, *how = new QVBoxLayout;
    auto* columns = new QHBoxLayout;
    columns->addLayout(asked, 1);
    columns->addLayout(how, 1);
    box->addLayout(columns);
    const auto number_box = [&](QVBoxLayout& column, const char* name, const QString& label,
                                const QString& tip, double low, double high, double value, int decimals,
                                const QString& unit) {
        auto* n = new NumberBox;
        n->setObjectName(QString::fromLatin1(name));
        n->setDecimals(decimals);
        n->setRange(low, high);
        n->setValue(value);
        n->setSuffix(unit);
        add_field(column, label, n, tip);
        connect(n, &NumberBox::valueChanged, this, [this] { forget_proposal(); });
        return n;
    };
    const ProposeOptions usual;
    wanted_ =
        number_box(*asked, "place_wanted", tr("Wanted 3 sigma"), tr("Across the bead, at its worst point"),
                   0.001, 10, usual.three_sigma_mm, 3, tr(" mm"));
    const auto count = [&](const char* name, const QString& label, int value) {
        auto* n = new QSpinBox;
        n->setObjectName(QString::fromLatin1(name));
        n->setRange(2, kMostSpots);
        n->setValue(value);
        n->setFocusPolicy(Qt::StrongFocus);
        add_field(*asked, label, n, tr("How many spots may be proposed"));
        connect(n, &QSpinBox::valueChanged, this, [this] { forget_proposal(); });
        return n;
    };
    fewest_ = count("place_fewest", tr("Spots, at least"), usual.fewest);
    most_ = count("place_most", tr("Spots, at most"), usual.most);
    cone_ = number_box(*how, "place_cone", tr("Turned by up to"),
                       tr("The sensor about the edge; 0: the middle of the two faces alone"), 0, 80,
                       usual.cone_deg, 1, tr(" degrees"));
    beyond_ = number_box(*how, "place_beyond", tr("Beyond its ends by up to"),
                         tr("Of the edge, along its chain. A part that bends is measured best near its bead"),
                         0, kAllAlong_mm, kAllAlong_mm, 0, tr(" mm"));
    noise_ = number_box(*how, "place_noise", tr("Noise of a point"),
                        tr("Of a profile, one standard deviation"), 0.0005, 1, usual.noise_mm, 4, tr(" mm"));
    lost_ = new QCheckBox(tr("Any single spot may be lost"));
    lost_->setObjectName("place_lost");
    lost_->setChecked(usual.one_may_be_lost);
    lost_->setMinimumHeight(style::kTargetPx);
    lost_->setToolTip(tr("The bead is known well enough without it too"));
    connect(lost_, &QCheckBox::toggled, this, [this] { forget_proposal(); });
    box->addWidget(lost_);
    propose_ = make_button("place_propose", "measure", tr("Propose spots"),
                           tr("The fewest that are enough, then the shortest way"), [this] { propose(); });
    cancel_ = make_button("place_cancel", "stop", tr("Cancel"), tr("Stops reading or proposing"), [this] {
        thread_.request_stop();
        cancel_->setEnabled(false);
    });
    progress_ = new QProgressBar;
    progress_->setObjectName("place_progress");
    progress_->setRange(0, 100);
    progress_->setMinimumHeight(style::kTargetPx);
    box->addLayout(make_row({propose_, cancel_, progress_}));
    verdict_ = make_text({});
    verdict_->setObjectName("place_verdict");
    verdict_->setMinimumHeight(3 * verdict_->fontMetrics().lineSpacing());
    verdict_->setAlignment(Qt::AlignLeft | Qt::AlignTop);
    box->addWidget(verdict_);
    spots_ = make_table("place_spots",
                        {tr("Spot"), tr("Along, mm"), tr("Turned, degrees"), tr("Sigma, mm"), tr("Feature")},
                        tr("In the order of the way; sigma of the feature, the larger one"));
    spots_->setMinimumHeight((kRowsSeen + 1) * style::kTargetPx);
    box->addWidget(spots_, 1);
    back_ = make_button("place_back", "up", tr("Back along the edge"),
                        tr("The chosen spot to the next free place; or drag its ghost in the 3D view"),
                        [this] { step(-1); });
    on_ = make_button("place_on", "down", tr("On along the edge"),
                      tr("The chosen spot to the next free place; or drag its ghost in the 3D view"),
                      [this] { step(1); });
    box->addLayout(make_row({back_, on_}));
    connect(spots_, &QTableWidget::currentCellChanged, this, [this] { state(); });
    take_ =
        make_button("place_take", "teach", tr("Take them into the project"),
                    tr("From the drawing, not confirmed: nothing is pushed by them until they are measured"),
                    [this] { take(); });
    box->addLayout(make_row({take_, make_button("place_close", "stop", tr("Close"),
                                                tr("The drawing leaves the scene"), [this] { close(); })}));
    connect(edge_, &QComboBox::currentIndexChanged, this, [this] { show_edge(); });
    connect(region_, &QComboBox::currentIndexChanged, this, [this] { forget_proposal(); });
    connect(&scene_, &SceneView::edge_picked, this, &PlaceDialog::choose_edge);
    connect(&scene_, &SceneView::proposed_dragged, this, &PlaceDialog::drag);
    connect(&desk_, &Desk::opened, this, &QDialog::close);
    const auto regions = [this] {
        filling_ = true;
        const QVariant chosen = region_->currentData();
        region_->clear();
        region_->addItem(tr("a new one"), QString());
        for (const Region& r : desk_.project().regions)
            region_->addItem(QString::fromStdString(r.id), QString::fromStdString(r.id));
        region_->setCurrentIndex(std::max(0, region_->findData(chosen)));
        filling_ = false;
    };
    connect(&desk_, &Desk::project_changed, this, regions);
    regions();
    set_verdict(*verdict_, tr("Choose the part's drawing."), Tone::plain);
    state();
}

PlaceDialog::~PlaceDialog() {
    scene_.set_edges({});
    scene_.set_proposed({});
    if (desk_.is_open() && desk_.project().part.mesh_ply.empty()) scene_.set_part({});
}

void PlaceDialog::state() {
    choose_->setEnabled(!working_);
    edge_->setEnabled(!working_ && read_);
    propose_->setEnabled(!working_ && read_ && edge_->count() > 0);
    cancel_->setEnabled(working_);
    take_->setEnabled(!working_ && proposal_ && proposal_->set.enough);
    for (QPushButton* step : {back_, on_})
        step->setEnabled(!working_ && proposal_ && spots_->currentRow() >= 0);
    if (!working_) progress_->setValue(0);
}

// `make` on a thread of its own, `done` here again.
template <class Made>
void PlaceDialog::begin(
    std::function<Made(const std::stop_token&, const std::function<void(double, const Text&)>&)> make,
    std::function<void(Made)> done) {
    working_ = true;
    forget_proposal();
    thread_ =
        std::jthread([this, make = std::move(make), done = std::move(done)](const std::stop_token& stop) {
            int last = -1;
            const auto tell = [&](double share, const Text& what) {
                const int percent = static_cast<int>(100 * share);
                if (percent == last) return;
                last = percent;
                QMetaObject::invokeMethod(
                    this,
                    [this, percent, what] {
                        if (!working_) return;
                        progress_->setValue(percent);
                        set_verdict(*verdict_, shown(what), Tone::plain);
                    },
                    Qt::QueuedConnection);
            };
            auto made = std::make_shared<Made>(make(stop, tell));
            QMetaObject::invokeMethod(
                this,
                [this, made, done] {
                    working_ = false;
                    done(std::move(*made));
                    state();
                },
                Qt::QueuedConnection);
        });
}

void PlaceDialog::choose_file() {
    const QString file = QFileDialog::getOpenFileName(
        this, tr("Drawing"), QFileInfo(QString::fromStdString(desk_.path().string())).path(),
        tr("Drawings (*.step *.stp *.iges *.igs *.stl *.ply *.obj);;All files (*)"));
    if (!file.isEmpty()) take_file(file);
}

void PlaceDialog::take_file(const QString& file) {
    if (working_) return;
    read_.reset();
    scene_.set_edges({});
    edge_->clear();
    file_->setText(file);
    begin<Expected<ReadDrawing>>(
        [path = file.toStdString()](const std::stop_token& stop, const auto& tell) -> Expected<ReadDrawing> {
            DrawingOptions options;
            options.chord_mm = kChord_mm;
            options.cancel = stop;
            options.progress = tell;
            ReadDrawing read;
            SEAM_TRY(read.file, read_text_file(path, kLargestDrawing));
            SEAM_TRY(read.drawing, read_drawing(std::as_bytes(std::span(read.file)),
                                                std::filesystem::path(path).filename().string(), options));
            return read;
        },
        [this](Expected<ReadDrawing> read) { show_drawing(std::move(read)); });
}

void PlaceDialog::show_drawing(Expected<ReadDrawing> read) {
    if (!read) return set_verdict(*verdict_, shown_error(read.error()), Tone::attention);
    read_ = std::make_shared<const ReadDrawing>(std::move(*read));
    std::vector<const DrawingEdge*> edges;
    for (const DrawingEdge& e : read_->drawing.edges) edges.push_back(&e);
    std::stable_sort(edges.begin(), edges.end(),
                     [](const DrawingEdge* a, const DrawingEdge* b) { return a->length_mm > b->length_mm; });
    std::vector<SceneEdge> drawn;
    filling_ = true;
    for (const DrawingEdge* e : edges) {
        edge_->addItem(QString::fromStdString(e->id) + QChar(0x20) + words_of(*e),
                       QString::fromStdString(e->id));
        SceneEdge one{e->id, {}, words_of(*e)};
        for (const DrawingPoint& p : e->points) one.points_mm.push_back(p.point_mm);
        drawn.push_back(std::move(one));
    }
    filling_ = false;
    if (desk_.project().part.mesh_ply.empty()) {
        SceneMesh mesh;
        for (const auto& v : read_->drawing.mesh.vertices)
            mesh.points.push_back(
                {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())});
        for (const auto& t : read_->drawing.mesh.triangles) mesh.triangles.push_back({t[0], t[1], t[2]});
        scene_.set_part(mesh);
    }
    scene_.set_edges(std::move(drawn));
    scene_.show_view(SceneView::View::fit);
    if (edges.empty())
        return set_verdict(*verdict_, tr("The drawing has no edge that a bead could follow."),
                           Tone::attention);
    set_verdict(*verdict_,
                tr("Click the edge that the bead follows in the 3D view, or choose it from the list."),
                Tone::plain);
    show_edge();
}

void PlaceDialog::choose_edge(const QString& id) {
    if (const int at = edge_->findData(id); at >= 0 && !working_) edge_->setCurrentIndex(at);
}

// The edge and what it goes on in.
void PlaceDialog::show_edge() {
    if (filling_ || !read_ || edge_->count() == 0) return;
    forget_proposal();
    const std::string id = edge_->currentData().toString().toStdString();
    std::vector<std::string> chain{id};
    if (const auto found = tangent_chain(read_->drawing, id))
        for (const EdgeChain::Part& part : found->parts)
            if (part.edge != id) chain.push_back(part.edge);
    scene_.choose_edges(chain);
}

void PlaceDialog::forget_proposal() {
    if (filling_) return;
    proposal_.reset();
    spots_->setRowCount(0);
    scene_.set_proposed({});
    state();
}

void PlaceDialog::propose() {
    if (working_ || !read_ || edge_->count() == 0) return;
    ProposeOptions options;
    options.edge = edge_->currentData().toString().toStdString();
    options.region_id = region_->currentData().toString().toStdString();
    options.three_sigma_mm = wanted_->value();
    options.fewest = fewest_->value();
    options.most = most_->value();
    options.one_may_be_lost = lost_->isChecked();
    options.cone_deg = cone_->value();
    if (beyond_->value() < kAllAlong_mm) options.beyond_mm = beyond_->value();
    options.noise_mm = noise_->value();
    begin<Expected<Proposal>>(
        [options, read = read_, project = desk_.project()](const std::stop_token& stop,
                                                           const auto& tell) mutable {
            options.cancel = stop;
            options.progress = tell;
            return propose_spots(project, read->drawing, options);
        },
        [this](Expected<Proposal> proposal) { show_proposal(std::move(proposal)); });
}

void PlaceDialog::show_proposal(Expected<Proposal> proposal) {
    if (!proposal) return set_verdict(*verdict_, shown_error(proposal.error()), Tone::attention);
    proposal_ = std::move(*proposal);
    const Proposal& p = *proposal_;
    QString said =
        tr("%1 spots on %2 mm of way: 3 sigma %3 mm at the worst point of the bead, wanted %4")
            .arg(p.spots.size())
            .arg(number(p.set.way_mm, 0), number(p.set.three_sigma_mm, 3), number(wanted_->value(), 3));
    if (lost_->isChecked())
        said += tr("; %1 mm with the worst spot lost").arg(number(p.set.lost_three_sigma_mm, 3));
    said += tr(". No set of as many gets below %1 mm.").arg(number(p.bound_mm, 3));
    if (!p.set.enough) said += QChar(0x20) + tr("Not enough: allow more spots, or a wider tolerance.");
    set_verdict(*verdict_, said, p.set.enough ? Tone::good : Tone::attention);
    QVector<QStringList> rows;
    std::vector<SceneSpot> ghosts;
    const Project& project = desk_.project();
    for (const ProposedSpot& s : p.spots) {
        rows.push_back({QString::fromStdString(s.spot.id), number(s.arc_mm, 1), number(s.turned_deg, 1),
                        number(s.sigma_mm.x(), 4), QString::fromStdString(s.spot.feature.kind)});
        const Calibration* calibration = calibration_of(project, s.spot);
        if (!calibration) continue;
        SceneSpot ghost;
        ghost.id = s.spot.id;
        ghost.workobject_from_sensor = project.part.base_from_workobject.inverse() * s.spot.base_from_flange *
                                       calibration->flange_from_sensor;
        ghost.reference_mm = s.spot.reference_mm;
        ghosts.push_back(ghost);
    }
    set_rows(*spots_, rows);
    scene_.set_proposed(ghosts);
}

bool PlaceDialog::move_to(const std::string& spot_id, std::size_t place) {
    auto moved = move_proposed(*proposal_, spot_id, place);
    if (!moved) return false;
    show_proposal(std::move(*moved));
    const auto& spots = proposal_->spots;
    const auto at =
        std::find_if(spots.begin(), spots.end(), [&](const ProposedSpot& p) { return p.spot.id == spot_id; });
    spots_->setCurrentCell(static_cast<int>(at - spots.begin()), 0);
    state();
    return true;
}

void PlaceDialog::drag(const QString& spot_id, const QPointF& at) {
    if (working_ || !proposal_) return;
    const std::vector<Eigen::Vector3d> places = places_of(*proposal_);
    const auto away = [&](const Eigen::Vector3d& place) {
        const QPointF d = scene_.to_screen(place) - at;
        return std::hypot(d.x(), d.y());
    };
    const auto nearest = std::min_element(places.begin(), places.end(),
                                          [&](const auto& a, const auto& b) { return away(a) < away(b); });
    if (nearest == places.end()) return;
    const auto place = static_cast<std::size_t>(nearest - places.begin());
    const std::string id = spot_id.toStdString();
    for (const ProposedSpot& p : proposal_->spots)
        if (p.spot.id == id && p.place != place) {
            move_to(id, place);
            return;
        }
}

void PlaceDialog::step(int way) {
    if (working_ || !proposal_ || spots_->currentRow() < 0) return;
    const ProposedSpot& spot = proposal_->spots[static_cast<std::size_t>(spots_->currentRow())];
    const std::string id = spot.spot.id;
    const std::size_t count = places_of(*proposal_).size();
    for (std::size_t place = spot.place + static_cast<std::size_t>(way); place < count;
         place += static_cast<std::size_t>(way))
        if (move_to(id, place)) return;
}

void PlaceDialog::take() {
    if (!proposal_ || !proposal_->set.enough || !read_) return;
    TakeOptions options;
    options.region_id = region_->currentData().toString().toStdString();
    auto taken = take_proposal(desk_.project(), read_->drawing, std::as_bytes(std::span(read_->file)),
                               *proposal_, options);
    if (!taken) return set_verdict(*verdict_, shown_error(taken.error()), Tone::attention);
    const auto count = taken->spot_ids.size();
    const std::string region = taken->region_id;
    if (auto kept = desk_.edit_project([&](Project& project) { project = std::move(taken->project); },
                                       tr("Spots from the drawing"));
        !kept)
        return set_verdict(*verdict_, shown_error(kept.error()), Tone::attention);
    forget_proposal();
    set_verdict(
        *verdict_,
        tr("%1 spots are in region %2, from the drawing: confirm each on the part (step Teach) before "
           "anything is pushed.")
            .arg(count)
            .arg(QString::fromStdString(region)),
        Tone::good);
}

}  // namespace seamwright
