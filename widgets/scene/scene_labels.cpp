#include <algorithm>

#include "widgets/scene/scene_view_impl.h"
#include "widgets/style.h"

namespace seamwright {

void SceneLabels::paint(QPainter& painter, const QWidget& owner) const {
    QColor ground = owner.palette().color(QPalette::Base);
    ground.setAlpha(205);
    painter.setFont(owner.font());
    const QFontMetrics metrics(owner.font());
    std::vector<QRectF> taken;
    const QRectF view = QRectF(owner.rect()).adjusted(2, 2, -2, -2);
    for (const Label& label : labels) {
        if (!view.contains(label.at)) continue;
        QRectF box(label.at + QPointF(11, -metrics.height() - 3),
                   QSizeF(metrics.horizontalAdvance(label.text) + 10, metrics.height() + 2));
        // Whole: what would reach beyond the view stands beside its rim.
        box.translate(std::max(std::min(0.0, view.right() - box.right()), view.left() - box.left()),
                      std::max(0.0, view.top() - box.top()));
        // Labels that would cover another one move down.
        for (int tries = 0; tries < 6; ++tries) {
            const bool covered =
                std::any_of(taken.begin(), taken.end(), [&](const QRectF& t) { return t.intersects(box); });
            if (!covered) break;
            box.translate(0, metrics.height() + 3);
        }
        taken.push_back(box);
        painter.fillRect(box, ground);
        if (label.strong) {
            painter.setPen(QPen(label.colour, 2));
            painter.drawRect(box);
        }
        painter.setPen(label.colour);
        painter.drawText(box, Qt::AlignCenter, label.text);
    }
    if (!foot.isEmpty()) {
        painter.setPen(style::quiet_text(owner.palette()));
        painter.drawText(owner.rect().adjusted(8, 4, -8, -6), Qt::AlignBottom | Qt::AlignLeft, foot);
    }
}

SceneLabels SceneView::Impl::words() const {
    SceneLabels words;
    const QPalette palette = view.palette();
    if (shown.at(Layer::labels)) {
        for (const SceneSpot& one : spots) {
            const Eigen::Vector3d at = canvas->project(one.workobject_from_sensor * one.reference_mm);
            if (at.z() > 1) continue;
            QString text = QString::fromStdString(one.id);
            if (!one.enabled) text = SceneView::tr("%1 (off)").arg(text);
            if (one.shift_mm && shown.at(Layer::corrections))
                text += SceneView::tr("  %1 mm").arg(one.shift_mm->norm(), 0, 'f', 2);
            const bool chosen = one.id == spot;
            words.labels.push_back(
                {{at.x(), at.y()}, text, chosen ? style::selection(palette) : style::text(palette), chosen});
        }
        if (next_robot && shown.at(Layer::robot)) {
            const Eigen::Vector3d at = canvas->project(next_robot->workobject_from_flange.translation());
            if (at.z() <= 1)
                words.labels.push_back(
                    {{at.x(), at.y()}, SceneView::tr("next pose"), style::selection(palette), true});
        }
        for (const SceneEdge& edge : edges) {
            const bool chosen = !chosen_edges.empty() && edge.id == chosen_edges.front();
            if ((edge.id != lit_edge && !chosen) || edge.points_mm.empty() || !shown.at(Layer::edges))
                continue;
            const Eigen::Vector3d at = canvas->project(edge.points_mm[edge.points_mm.size() / 2]);
            if (at.z() > 1) continue;
            const QString text = QString::fromStdString(edge.id) + QChar(0x20) + edge.words;
            words.labels.push_back({{at.x(), at.y()}, text, style::selection(palette), edge.id == lit_edge});
        }
        for (const SceneSpot& one : proposed) {
            const Eigen::Vector3d at = canvas->project(one.workobject_from_sensor * one.reference_mm);
            if (at.z() <= 1 && shown.at(Layer::edges))
                words.labels.push_back(
                    {{at.x(), at.y()}, QString::fromStdString(one.id), style::selection(palette), false});
        }
        for (std::size_t i = 0; i < picks.size(); ++i) {
            const Eigen::Vector3d at = canvas->project(picks[i]);
            if (at.z() <= 1)
                words.labels.push_back(
                    {{at.x(), at.y()}, QString::number(i + 1), style::selection(palette), true});
        }
        if (const auto worst = worst_of(path); worst && shown.at(Layer::path)) {
            const Eigen::Vector3d at = canvas->project(drawn_path(path, scale)[worst->point]);
            QString text = SceneView::tr("moved %1 mm").arg(worst->shift_mm, 0, 'f', 2);
            if (worst->sigma_mm > 0)
                text += SceneView::tr(", 3 sigma %1 mm").arg(3 * worst->sigma_mm, 0, 'f', 3);
            if (at.z() <= 1)
                words.labels.push_back({{at.x(), at.y()}, text, style::attention(palette), true});
        }
        if (shown.at(Layer::regions))
            for (const SceneRegion& one : regions) {
                const auto weak = weak_arrow(one, spots);
                if (!weak || one.weak_text.empty()) continue;
                const Eigen::Vector3d at = canvas->project(weak->tip);
                if (at.z() <= 1)
                    words.labels.push_back({{at.x(), at.y()},
                                            QString::fromStdString(one.id + ": " + one.weak_text),
                                            style::alarm(palette),
                                            false});
            }
    }
    const bool any =
        std::any_of(spots.begin(), spots.end(), [](const SceneSpot& s) { return s.shift_mm.has_value(); });
    if ((any && shown.at(Layer::corrections)) || (!path.after_mm.empty() && shown.at(Layer::path)))
        words.foot = SceneView::tr("corrections drawn × %1").arg(scale, 0, 'g', 3);
    else if (mesh.triangles.empty() && spots.empty())
        words.foot = SceneView::tr("No part yet: step 1, Cell, imports its mesh.");
    return words;
}

}  // namespace seamwright
