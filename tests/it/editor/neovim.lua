-- Run by tests/it/editor: tests the plugin of editors/neovim on real files. Prints one line of JSON; exits with status 1 after an error.
-- The environment gives the job, the model, and for some jobs steps in JSON.
local job, path = vim.env.SIDC_JOB, vim.env.SIDC_MODEL

-- Announces snippet support, as a snippet plugin would; Neovim 0.7 has none.
local capabilities = vim.lsp.protocol.make_client_capabilities
vim.lsp.protocol.make_client_capabilities = function()
  local all = capabilities()
  all.textDocument.completion.completionItem.snippetSupport = true
  return all
end

local function wait(what, ready)
  if not vim.wait(30000, ready, 5) then error("waited in vain for " .. what) end
end

-- Allows the cursor after the last character, as while typing.
vim.o.virtualedit = "onemore"

local buffer

-- The latest diagnostics, with the version of the text that they are for.
local latest = {}
vim.lsp.handlers["textDocument/publishDiagnostics"] = function(_, result)
  latest = { version = result.version, found = result.diagnostics }
end

local function diagnostics()
  local version = vim.lsp.util.buf_versions[buffer]
  wait("diagnostics", function() return latest.version == version end)
  local codes = {}
  for _, d in ipairs(latest.found) do table.insert(codes, d.code) end
  table.sort(codes)
  return codes
end

local function ask(method, params)
  local answers = vim.lsp.buf_request_sync(buffer, method, params, 30000)
  for _, answer in pairs(answers or {}) do
    if answer.error then error(method .. ": " .. answer.error.message) end
    return answer.result
  end
end

local function open()
  vim.cmd("edit " .. vim.fn.fnameescape(path))
  buffer = vim.api.nvim_get_current_buf()
  assert(vim.bo.filetype == "sid", "no file type")
  wait("the server", function() return #vim.lsp.buf_get_clients(buffer) > 0 end)
end

local function lines() return vim.api.nvim_buf_get_lines(buffer, 0, -1, false) end

local jobs = {}

-- The diagnostics of a file, its number of symbols, and the file after formatting.
function jobs.read()
  open()
  local document = { textDocument = vim.lsp.util.make_text_document_params() }
  local found = diagnostics()
  local symbols = ask("textDocument/documentSymbol", document) or {}
  vim.lsp.buf.formatting_sync(nil, 30000)
  return { found = found, symbols = #symbols, text = table.concat(lines(), "\n") }
end

-- Goes to a definition, renames the name under the cursor, breaks a line, and repairs it by a quick fix.
function jobs.change()
  open()
  diagnostics()
  vim.fn.search("ddtheta \\~")
  local place = ask("textDocument/definition", vim.lsp.util.make_position_params())
  local params = vim.lsp.util.make_position_params()
  params.newName = "phi"
  local edit = ask("textDocument/rename", params)
  vim.lsp.util.apply_workspace_edit(edit, "utf-16")
  local renamed = diagnostics()
  vim.api.nvim_buf_set_lines(buffer, -1, -1, false, { "symetry y, phi -> -(y, phi)" })
  local broken = diagnostics()
  local range = { start = { line = 0, character = 0 }, ["end"] = { line = 1000, character = 0 } }
  local actions = ask("textDocument/codeAction", {
    textDocument = vim.lsp.util.make_text_document_params(),
    range = range,
    context = { diagnostics = {} },
  })
  vim.lsp.util.apply_workspace_edit(actions[1].edit, "utf-16")
  return {
    line = place.range.start.line,
    renamed = renamed,
    broken = broken,
    title = actions[1].title,
    mended = diagnostics(),
    text = table.concat(lines(), "\n"),
  }
end

-- Types a model from nothing. Each step is a label that completion must offer, and the values for its places in order; `|` is where the
-- cursor continues. A step of three stays on its line.
function jobs.type()
  open()
  local function filled(text, values)
    return (text:gsub("%${(%d+)[:|]([^}]*)}", function(place, default)
      return values[tonumber(place)] or default:match("^[^,|]*")
    end))
  end
  -- Inserts text at a range, and puts the cursor at its `|` or after it.
  local function put(range, text)
    local goes_on = text:find("|", 1, true) or #text + 1
    local typed = vim.split(text:sub(1, goes_on - 1), "\n", { plain = true })
    local edit = { range = range, newText = (text:gsub("|", "")) }
    vim.lsp.util.apply_text_edits({ edit }, buffer, "utf-16")
    local before = #typed == 1 and range.start.character or 0
    vim.api.nvim_win_set_cursor(0, { range.start.line + #typed, before + #typed[#typed] })
  end
  local function complete(label, values)
    local row, column = unpack(vim.api.nvim_win_get_cursor(0))
    local items = ask("textDocument/completion", {
      textDocument = vim.lsp.util.make_text_document_params(),
      position = { line = row - 1, character = column },
    })
    for _, item in ipairs(items) do
      if item.label == label then return put(item.textEdit.range, filled(item.textEdit.newText, values)) end
    end
    local labels = vim.tbl_map(function(item) return item.label end, items)
    error(("no %s is offered in %s: %s"):format(label, vim.inspect(lines()), table.concat(labels, ", ")))
  end
  for number, step in ipairs(vim.fn.json_decode(vim.env.SIDC_STEPS)) do
    if number > 1 and not step[3] then
      local row = vim.api.nvim_buf_line_count(buffer)
      vim.api.nvim_buf_set_lines(buffer, row, row, false, { "" })
      vim.api.nvim_win_set_cursor(0, { row + 1, 0 })
    end
    complete(step[1], step[2])
  end
  return { found = diagnostics(), text = table.concat(lines(), "\n") }
end

-- Parses texts with editors/tree-sitter: the model is a JSON file of texts, the steps are the parser and a file of highlighting queries.
function jobs.trees()
  local parser, colours = unpack(vim.fn.json_decode(vim.env.SIDC_STEPS))
  local function read(path)
    local file = assert(io.open(path))
    local all = file:read("*a")
    file:close()
    return all
  end

  if vim.treesitter.language and vim.treesitter.language.add then
    vim.treesitter.language.add("sid", { path = parser })
  else
    vim.treesitter.require_language("sid", parser)
  end
  local query = (vim.treesitter.query.parse or vim.treesitter.parse_query)("sid", read(colours))

  -- Whether a text parses, the first byte of each statement, and the first and last byte of each word with its highlight.
  local function seen(text)
    local root = vim.treesitter.get_string_parser(text, "sid"):parse()[1]:root()
    local statements, words = vim.empty_dict(), vim.empty_dict()
    for node in root:iter_children() do
      local _, _, start = node:start()
      if node:type() ~= "comment" then table.insert(statements, start) end
    end
    for capture, node in query:iter_captures(root, text, 0, -1) do
      local _, _, start = node:start()
      local _, _, stop = node:end_()
      table.insert(words, { start, stop, query.captures[capture] })
    end
    return { sound = not root:has_error(), statements = statements, words = words }
  end

  return { trees = vim.tbl_map(seen, vim.fn.json_decode(read(path))) }
end

local ok, result = pcall(jobs[job])
if ok then
  io.stdout:write(vim.fn.json_encode(result) .. "\n")
  vim.cmd("qall!")
else
  io.stderr:write(result .. "\n")
  vim.cmd("cquit!")
end
