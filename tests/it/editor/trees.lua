-- Run by trees.rs: the parser of editors/tree-sitter in Neovim. Prints one line of JSON, and ends with the status 1 after an error.
-- From the environment: the parser, the file of colours, and a file of texts in JSON.
local parser, colours, texts = vim.env.SIDC_PARSER, vim.env.SIDC_COLOURS, vim.env.SIDC_TEXTS

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

-- Whether a text is understood, the first byte of each statement, and the first and last byte of each word with its colour.
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

local ok, result = pcall(function() return vim.tbl_map(seen, vim.fn.json_decode(read(texts))) end)
if ok then
  io.stdout:write(vim.fn.json_encode(result) .. "\n")
  vim.cmd("qall!")
else
  io.stderr:write(result .. "\n")
  vim.cmd("cquit!")
end
