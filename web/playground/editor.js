// The text: CodeMirror, with the colours that Surefoot's own lexer gives and with what the compiler found underlined.

import { basicSetup } from 'codemirror';
import { EditorState, StateEffect, StateField } from '@codemirror/state';
import { Decoration, EditorView } from '@codemirror/view';
import { setDiagnostics } from '@codemirror/lint';
import { indentUnit } from '@codemirror/language';

const recolour = StateEffect.define();
const colours = StateField.define({
  create: () => Decoration.none,
  update(marks, transaction) {
    const effect = transaction.effects.find((effect) => effect.is(recolour));
    return effect ? effect.value : marks.map(transaction.changes);
  },
  provide: (field) => EditorView.decorations.from(field),
});
const kinds = Object.fromEntries(['keyword', 'kind', 'number', 'text', 'color', 'comment', 'doc', 'error'].map((kind) => [kind, Decoration.mark({ class: `sf-${kind}` })]));

const look = EditorView.theme({
  '&': { backgroundColor: 'var(--ground)', color: 'var(--ink)', fontSize: '13.5px' },
  '.cm-scroller': { fontFamily: 'ui-monospace, "SF Mono", "Cascadia Mono", Menlo, Consolas, "DejaVu Sans Mono", monospace', lineHeight: '1.55' },
  '.cm-content': { caretColor: 'var(--ink)' },
  '.cm-cursor, .cm-dropCursor': { borderLeftColor: 'var(--ink)' },
  '&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground': { backgroundColor: 'var(--selection)' },
  '&.cm-focused': { outline: 'none' },
  '.cm-gutters': { backgroundColor: 'var(--ground)', color: 'var(--soft)', border: 'none' },
  '.cm-activeLine, .cm-activeLineGutter': { backgroundColor: 'var(--active)' },
  '.cm-matchingBracket, &.cm-focused .cm-matchingBracket': { backgroundColor: 'var(--selection)' },
  '.cm-selectionMatch': { backgroundColor: 'var(--active)' },
  '.cm-panels': { backgroundColor: 'var(--raised)', color: 'var(--ink)' },
  '.cm-tooltip': { backgroundColor: 'var(--raised)', color: 'var(--ink)', border: '1px solid var(--line)', borderRadius: '7px', overflow: 'hidden', maxWidth: '46em' },
  '.cm-tooltip-autocomplete ul li[aria-selected]': { backgroundColor: 'var(--selection)', color: 'var(--ink)' },
  '.cm-diagnostic': { padding: '6px 10px', whiteSpace: 'pre-wrap' },
  '.cm-diagnostic-error': { borderLeftColor: 'var(--error)' },
  '.cm-diagnostic-warning': { borderLeftColor: 'var(--warning)' },
  '.cm-lintRange-error': { backgroundImage: 'none', textDecoration: 'underline wavy var(--error) 1.5px', textUnderlineOffset: '3px', textDecorationSkipInk: 'none' },
  '.cm-lintRange-warning': { backgroundImage: 'none', textDecoration: 'underline wavy var(--warning) 1.5px', textUnderlineOffset: '3px', textDecorationSkipInk: 'none' },
  '.sf-keyword': { color: 'var(--keyword)' },
  '.sf-kind': { color: 'var(--kind)' },
  '.sf-number, .sf-color': { color: 'var(--number)' },
  '.sf-text': { color: 'var(--string)' },
  '.sf-comment, .sf-doc': { color: 'var(--comment)', fontStyle: 'italic' },
  '.sf-error': { color: 'var(--error)' },
});

// An editor in `parent`. `colourer` is a compiler of this thread: its tokens come before the next picture of the page. `changed` is told of each edit.
export function editor(parent, colourer, changed) {
  async function colour(view) {
    const { doc } = view.state;
    const tokens = await colourer.tokens(doc.toString()).catch(() => []);
    if (view.state.doc !== doc) return;
    const marks = tokens.filter(([from, to, kind]) => kinds[kind] && from < to).map(([from, to, kind]) => kinds[kind].range(from, to));
    view.dispatch({ effects: recolour.of(Decoration.set(marks)) });
  }
  const view = new EditorView({
    parent,
    state: EditorState.create({
      extensions: [
        basicSetup,
        look,
        colours,
        indentUnit.of('  '),
        EditorState.languageData.of(() => [{ commentTokens: { line: '//', block: { open: '/*', close: '*/' } } }]),
        EditorView.contentAttributes.of({ 'aria-label': 'The scene as text', spellcheck: 'false', autocapitalize: 'off', autocorrect: 'off' }),
        EditorView.updateListener.of((update) => {
          if (!update.docChanged) return;
          colour(update.view);
          changed();
        }),
      ],
    }),
  });
  const text = () => view.state.doc.toString();
  return {
    text,
    write: (words) => {
      view.dispatch({ changes: { from: 0, to: view.state.doc.length, insert: words }, selection: { anchor: 0 } });
      view.scrollDOM.scrollTo(0, 0);
    },
    // Underlines what was found in a text that still stands here. A place in another file has none.
    underline: (found, name) => {
      const length = view.state.doc.length;
      const marks = found.filter((one) => one.file === name).map((one) => {
        const from = Math.min(one.start, length);
        return { from, to: Math.min(Math.max(one.end, from + 1), length), severity: one.severity, message: one.help ? `${one.message}\n${one.help}` : one.message };
      });
      view.dispatch(setDiagnostics(view.state, marks));
    },
    go: (at) => {
      view.dispatch({ selection: { anchor: Math.min(at, view.state.doc.length) }, scrollIntoView: true });
      view.focus();
    },
  };
}
