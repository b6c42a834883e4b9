-- Starts `sidc lsp` for every model; vim.g.sidc_path names the program if it is not on the path. Works with Neovim 0.7 or later.
if vim.b.did_ftplugin then return end
vim.b.did_ftplugin = 1

vim.bo.commentstring = "# %s"
vim.bo.comments = ":#"
vim.bo.expandtab = true
vim.bo.shiftwidth = 2
vim.bo.omnifunc = "v:lua.vim.lsp.omnifunc"

local buffer = vim.api.nvim_get_current_buf()
local folder = vim.fn.fnamemodify(vim.api.nvim_buf_get_name(buffer), ":p:h")
local config = {
  name = "sidc",
  cmd = { vim.g.sidc_path or "sidc", "lsp" },
  root_dir = folder,
}

if vim.lsp.start then
  vim.lsp.start(config)
else
  -- One server for all models.
  if not vim.g.sidc_client or not vim.lsp.get_client_by_id(vim.g.sidc_client) then
    vim.g.sidc_client = vim.lsp.start_client(config)
  end
  if vim.g.sidc_client then vim.lsp.buf_attach_client(buffer, vim.g.sidc_client) end
end

if vim.lsp.inlay_hint and vim.lsp.inlay_hint.enable then
  vim.lsp.inlay_hint.enable(true, { bufnr = buffer })
end

-- :SidcIdentify [DATA…] and :SidcCheck [DATA…] run the program on this model in a terminal split.
local function run(command)
  return function(args)
    vim.cmd("write")
    local words = { vim.g.sidc_path or "sidc", command, vim.api.nvim_buf_get_name(buffer) }
    vim.list_extend(words, args.fargs)
    vim.cmd("botright new")
    vim.fn.termopen(words)
  end
end
vim.api.nvim_buf_create_user_command(buffer, "SidcIdentify", run("identify"), { nargs = "*", complete = "file" })
vim.api.nvim_buf_create_user_command(buffer, "SidcCheck", run("check"), { nargs = "*", complete = "file" })
