"""Pictures of drives and studies, for print by matplotlib and for pages by plotly."""
