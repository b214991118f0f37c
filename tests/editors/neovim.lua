-- Neovim as a client of `surefoot lsp`: opens two files, and looks at what a person would see.
--
--     nvim --headless -u NONE -c "luafile tests/editors/neovim.lua"
--
-- SUREFOOT is the program, SUREFOOT_FOLDER a folder that this may write. Ends with code 1 where something is not as it should be.

local program = assert(os.getenv('SUREFOOT'), 'set SUREFOOT')
local folder = assert(os.getenv('SUREFOOT_FOLDER'), 'set SUREFOOT_FOLDER')

local main = { 'import "parts.sdf"', 'param size = 1 in 0.5..2 "how large"', 'scene = column(size).twist(y, 0.5) | spere(size)' }
local parts = { '/// A column, round.', 'field column(radius: float) = max(length(p.xz) - radius, abs(p.y) - 1)' }
local checks = 0

local function check(condition, words, found)
  checks = checks + 1
  if not condition then
    error(words .. ': ' .. vim.inspect(found), 0)
  end
end

-- Puts the caret on the first letter of some words; answers what requests ask for.
local function at(words)
  for row, line in ipairs(vim.api.nvim_buf_get_lines(0, 0, -1, true)) do
    local column = line:find(words, 1, true)
    if column then
      vim.api.nvim_win_set_cursor(0, { row, column - 1 })
      return vim.lsp.util.make_position_params(0, 'utf-16')
    end
  end
  error('no ' .. words .. ' in the text', 0)
end

local function lines(buffer)
  return table.concat(vim.api.nvim_buf_get_lines(buffer or 0, 0, -1, true), '\n')
end

local function run()
  vim.fn.writefile(main, folder .. '/main.sdf')
  vim.fn.writefile(parts, folder .. '/parts.sdf')
  vim.o.hidden = true
  vim.cmd('edit ' .. vim.fn.fnameescape(folder .. '/main.sdf'))
  local buffer = vim.api.nvim_get_current_buf()
  vim.bo[buffer].filetype = 'surefoot'
  local id = vim.lsp.start_client({ name = 'surefoot', cmd = { program, 'lsp' }, root_dir = folder })
  check(id, 'the server starts', id)
  vim.lsp.buf_attach_client(buffer, id)
  check(vim.wait(20000, function() return vim.lsp.get_client_by_id(id) and vim.lsp.get_client_by_id(id).initialized end), 'the server greets')
  local client = vim.lsp.get_client_by_id(id)
  local function ask(method, params)
    local answer, why = client.request_sync(method, params, 20000, buffer)
    check(answer and not answer.err, method, answer and answer.err or why)
    return answer.result
  end

  -- What is wrong is shown.
  check(vim.wait(30000, function() return #vim.diagnostic.get(buffer) > 0 end), 'a problem is told')
  local told = vim.diagnostic.get(buffer)
  check(#told == 1 and told[1].message:find('did you mean `sphere`', 1, true) and told[1].lnum == 2, 'the problem', told)

  -- And mended.
  local params = vim.tbl_extend('force', at('spere'), { range = { start = at('spere').position, ['end'] = at('spere').position }, context = { diagnostics = {} } })
  local actions = ask('textDocument/codeAction', params)
  check(#actions == 1 and actions[1].title == 'Write `sphere`', 'the mending', actions)
  vim.lsp.util.apply_workspace_edit(actions[1].edit, 'utf-16')
  check(lines():find('sphere(size)', 1, true), 'the text is mended', lines())
  check(vim.wait(30000, function() return #vim.diagnostic.get(buffer) == 0 end), 'the problem goes', vim.diagnostic.get(buffer))

  local items = vim.lsp.util.text_document_completion_list_to_complete_items(ask('textDocument/completion', at('twist')), 'tw')
  check(#items == 1 and items[1].abbr == 'twist', 'a completion', items)

  local said = ask('textDocument/hover', at('twist')).contents.value
  check(said:find('warp twist(axis: vec3, rate: float)', 1, true) and said:find('**Factor ×2.', 1, true), 'a hover', said)

  -- Goes there, as a key would.
  at('column')
  vim.lsp.buf.definition()
  check(vim.wait(20000, function() return vim.api.nvim_buf_get_name(0):find('parts.sdf', 1, true) end), 'it goes to the definition', vim.api.nvim_buf_get_name(0))
  check(vim.deep_equal(vim.api.nvim_win_get_cursor(0), { 2, 6 }), 'the place of the definition', vim.api.nvim_win_get_cursor(0))
  local other = vim.api.nvim_get_current_buf()
  vim.lsp.buf_attach_client(other, id)

  -- Renames over both files, as a key would.
  vim.lsp.buf.rename('pillar')
  local function renamed() return lines(buffer):find('pillar(size)', 1, true) and lines(other):find('field pillar(', 1, true) end
  check(vim.wait(20000, renamed), 'both files have the new name', { lines(buffer), lines(other) })
  check(not (lines(buffer) .. lines(other)):find('column(', 1, true), 'the old name is gone', { lines(buffer), lines(other) })

  -- Lays out.
  vim.api.nvim_set_current_buf(buffer)
  vim.api.nvim_buf_set_lines(buffer, 1, 2, true, { 'param   size=1   in 0.5..2 "how large"' })
  local edits = ask('textDocument/formatting', vim.lsp.util.make_formatting_params())
  vim.lsp.util.apply_text_edits(edits, buffer, 'utf-16')
  check(lines():find('param size = 1 in 0.5..2 "how large"', 1, true), 'the text is laid out', lines())

  client.stop()
  check(vim.wait(20000, function() return client.is_stopped() end), 'the server stops')
end

local fine, why = pcall(run)
if not fine then
  io.stderr:write('neovim: ' .. tostring(why) .. '\n')
  vim.cmd('cquit 1')
end
io.stdout:write(checks .. ' checks in Neovim ' .. tostring(vim.version().major) .. '.' .. vim.version().minor .. '.' .. vim.version().patch .. '\n')
vim.cmd('qall!')
