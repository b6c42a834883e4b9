vim.api.nvim_create_autocmd({ "BufRead", "BufNewFile" }, {
  pattern = "*.sid",
  callback = function() vim.bo.filetype = "sid" end,
})
