#pragma once
// A plot's legend in a row of its own: nothing stands over the data. Needs QCustomPlot's header: for implementation files only.

#include <qcustomplot.h>

#include "widgets/style.h"

namespace seamwright {

inline void put_legend_above(QCustomPlot& plot) {
    constexpr double kShare = 0.001;  // of the height: as little as it needs
    QCPLegend* legend = plot.legend;
    legend->setBorderPen(Qt::NoPen);
    legend->setBrush(Qt::NoBrush);
    legend->setFillOrder(QCPLegend::foColumnsFirst);
    plot.plotLayout()->insertRow(0);
    plot.plotLayout()->addElement(0, 0, legend);
    plot.plotLayout()->setRowStretchFactor(0, kShare);
}

inline void show_legend(QCustomPlot& plot, const QWidget& owner) {
    plot.legend->setVisible(true);
    plot.legend->setFont(owner.font());
    plot.legend->setTextColor(style::quiet_text(owner.palette()));
}

}  // namespace seamwright
