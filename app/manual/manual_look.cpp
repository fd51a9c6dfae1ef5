#include "app/manual/manual_look.h"

#include <QAbstractTextDocumentLayout>
#include <QTextBlock>
#include <QTextCursor>
#include <QTextTable>
#include <vector>

#include "widgets/style.h"

namespace seamwright {
namespace {

// Of the running text's size.
constexpr double kTitle = 1.7, kChapter = 1.25, kAir = 0.55, kCell = 0.2, kMargin = 1.6;
constexpr double kScreenDpi = 96;

void set_table(QTextTable& table, double em_px, const QPalette& palette) {
    QTextTableFormat format = table.format();
    format.setBorder(1);
    format.setBorderStyle(QTextFrameFormat::BorderStyle_Solid);
    format.setBorderBrush(style::grid(palette));
    format.setBorderCollapse(true);
    format.setCellSpacing(0);
    format.setCellPadding(kCell * em_px);
    format.setBottomMargin(kAir * em_px);
    format.setHeaderRowCount(1);
    table.setFormat(format);
    for (int c = 0; c < table.columns(); ++c) {
        QTextCursor cell = table.cellAt(0, c).firstCursorPosition();
        cell.setPosition(table.cellAt(0, c).lastPosition(), QTextCursor::KeepAnchor);
        QTextCharFormat bold;
        bold.setFontWeight(QFont::DemiBold);
        cell.mergeCharFormat(bold);
    }
}

// A picture keeps its line as high as itself.
bool holds_picture(const QTextBlock& block) {
    return block.text().contains(QChar::ObjectReplacementCharacter);
}

// Markdown's own steps of size go.
void set_sizes(const QTextBlock& block, double pt, bool bold) {
    std::vector<std::pair<int, int>> pieces;
    for (auto piece = block.begin(); !piece.atEnd(); ++piece)
        pieces.emplace_back(piece.fragment().position(), piece.fragment().length());
    QTextCursor cursor(block);
    for (const auto& [position, length] : pieces) {
        cursor.setPosition(position);
        cursor.setPosition(position + length, QTextCursor::KeepAnchor);
        QTextCharFormat format = cursor.charFormat();
        format.clearProperty(QTextFormat::FontSizeAdjustment);
        format.setFontPointSize(pt);
        if (bold) format.setFontWeight(QFont::DemiBold);
        cursor.setCharFormat(format);
    }
}

}  // namespace

void set_manual_look(QTextDocument& document, double em_pt, const QPalette& palette) {
    const QPaintDevice* paper = document.documentLayout()->paintDevice();
    const double em_px = em_pt / 72 * (paper ? paper->logicalDpiY() : kScreenDpi);
    document.setDocumentMargin(kMargin * em_px);
    QTextCursor all(&document);
    all.beginEditBlock();  // laid out once
    for (QTextBlock block = document.begin(); block.isValid(); block = block.next()) {
        QTextCursor cursor(block);
        QTextBlockFormat format = block.blockFormat();
        const int level = format.headingLevel();
        const bool in_table = cursor.currentTable();
        format.setTopMargin(in_table ? 0 : (level == 2 ? 2.5 : level == 1 ? 0 : 0.5) * kAir * em_px);
        format.setBottomMargin(in_table ? 0 : 0.5 * kAir * em_px);
        if (!holds_picture(block)) format.setLineHeight(120, QTextBlockFormat::ProportionalHeight);
        cursor.setBlockFormat(format);
        set_sizes(block, em_pt * (level == 1 ? kTitle : level == 2 ? kChapter : 1), level > 0);
        if (QTextTable* table = cursor.currentTable();
            table && block == table->cellAt(0, 0).firstCursorPosition().block())
            set_table(*table, em_px, palette);
    }
    all.endEditBlock();
}

}  // namespace seamwright
